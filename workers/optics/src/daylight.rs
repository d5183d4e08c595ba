//! Light from above: how bright the water is in every direction, and the veil that follows from it.
//!
//! Downwelling irradiance falls with depth as `E(z) = E(0) e^{−K z}`. Radiance in the direction v that one looks in, with μ the
//! cosine of v from the vertical (1 up, −1 down), is
//!
//! ```text
//! L(v, z) = max( Λ E(z) Φ(μ), W(μ, z) ),   Φ(μ) = exp(p μ + q μ²)
//! ```
//!
//! Λ is the horizon's share of the irradiance and W the sky through Snell's window. Under an overcast sky `Λ = min(0.15, 0.47
//! b_b/a)`, `q = clamp((0.45 ln(1/Λ) − 0.76)/1.03, 0, 2.5)` and `p = 1.6 + q` fit Monte Carlo runs in Fournier–Forand water (b_b/b
//! 0.008 and 0.0183, b/a 0.3 to 5) at K z of 0.5 to 3: Λ within 20 %, every direction of two other waters within 0.89-1.20. Not
//! valid above K z of 0.3, for a low sun, or near the bottom.
//!
//! Along a ray the source of the veil falls with depth like the irradiance (Duntley 1963; Preisendorfer 1976), so that
//!
//! ```text
//! B(v, Z) = B_h Φ(μ) (1 − e^{−(c − K μ) Z})
//! ```
//!
//! with B_h the veiling light at the horizon. Horizontally this is the veil of constant water. A pixel without a range shows the
//! water up to the surface, at `Z = h/μ`, and the window; downwards it shows `B_h Φ(μ)`.
//!
//! All lengths here are those of the range, and coefficients are per unit of it: a range scale multiplies the ones and divides
//! the depth.

mod caustics;
mod field;
mod gaze;
mod limits;
mod model;
mod seen;
mod slope;
mod sun;
mod surface;
mod veil;

pub use caustics::{
    Blur, RAYS_PER_CELL, Refraction, Tiles, Waves, caustics, caustics_reference, shafts, slices,
    tile_reference, with_shafts,
};
pub use field::{CRITICAL_COSINE, Field, REFRACTIVE_INDEX, Shape, decay_from, fresnel};
pub use gaze::Gaze;
pub use model::{Caustics, DaylightModel, Sun, SurfaceLight, VeilModel};
pub use seen::{
    Surfaces, access, access_reference, occlude_veil, sunlit, sunlit_reference, veil_access,
    veil_access_reference,
};
pub use slope::{SLOPES, share_by_slope};
pub use sun::SunLight;
pub use surface::{Reaching, surfaces, surfaces_reference, with_lamps};
pub use veil::{VeilOf, veil, veil_reference};

/// The veil's exponent keeps at least this share of c: light cannot decay faster upwards than along a ray.
pub const MOST_DECAY: f64 = 0.95;

/// An effect of daylight that a picture can do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DaylightEffect {
    /// Shadows of the sun.
    SunShadow,
    /// Ambient occlusion of surfaces.
    AmbientOcclusion,
    /// The pattern of the waves on surfaces.
    Caustics,
    /// The pattern of the waves in the water.
    Shafts,
    /// Occlusion of the daylight that the veil comes from.
    VeilOcclusion,
}

/// Light from above in one water, as one camera meets it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Daylight {
    pub(crate) veil: VeilModel,
    pub(crate) surfaces: SurfaceLight,
    pub(crate) sun: Option<SunLight>,
    /// Rays that tell how much of the light from all around reaches a surface.
    pub(crate) rays: usize,
    /// The waves, and how the water blurs what they draw.
    pub(crate) caustics: Option<(Caustics, Blur)>,
    /// Whether the pattern of the waves shows on surfaces.
    pub(crate) draws_caustics: bool,
    pub(crate) has_shafts: bool,
    /// Whether surfaces occlude the daylight that the veil comes from.
    pub(crate) occludes_veil: bool,
    /// True meters of one length of the range.
    pub(crate) scale: f64,
    /// The radiance of each channel.
    pub(crate) fields: [Field; 3],
    /// Depth of the camera in lengths of the range.
    pub(crate) depth: f64,
    /// The irradiance at the camera over that which is white.
    pub(crate) level: [f64; 3],
    pub(crate) gaze: Gaze,
}

impl Daylight {
    /// Leaves an effect out.
    pub(crate) fn leave_out(&mut self, effect: DaylightEffect) {
        match effect {
            DaylightEffect::SunShadow => {
                if let Some(sun) = &mut self.sun {
                    sun.casts_shadows = false;
                }
            }
            DaylightEffect::AmbientOcclusion => self.rays = 0,
            DaylightEffect::Caustics => self.draws_caustics = false,
            DaylightEffect::Shafts => self.has_shafts = false,
            DaylightEffect::VeilOcclusion => self.occludes_veil = false,
        }
    }

    /// Whether the veil depends on the direction.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.veil != VeilModel::Constant
    }

    /// Whether radiance by direction matters to any of it.
    #[must_use]
    pub fn needs_field(&self) -> bool {
        self.varies() || self.surfaces == SurfaceLight::Normal
    }

    /// What it does to surfaces.
    #[must_use]
    pub fn surfaces(&self) -> SurfaceLight {
        self.surfaces
    }

    /// The sun, where it shines on surfaces.
    #[must_use]
    pub fn sun(&self) -> Option<&SunLight> {
        self.sun.as_ref()
    }

    /// Where the camera looks.
    #[must_use]
    pub fn gaze(&self) -> &Gaze {
        &self.gaze
    }

    /// The downwelling irradiance just below the surface, where that which is white lights a white patch to a radiance of 1.
    #[must_use]
    pub fn at_surface(&self) -> [f64; 3] {
        let rise = |i: usize| (self.fields[i].decay * self.depth).exp();
        [0, 1, 2].map(|i| std::f64::consts::PI * self.level[i] * rise(i))
    }

    /// Whether waves draw a pattern with the sun.
    #[must_use]
    pub fn has_waves(&self) -> bool {
        self.caustics.is_some()
    }

    /// The waves of a seed in the frame with this number, and how the water blurs what they draw with the sun.
    #[must_use]
    pub fn waves(&self, seed: u64, frame: u64) -> Option<(Waves, Blur)> {
        self.sun?;
        let (described, blur) = self.caustics?;
        Some((Waves::new(&described, seed, frame), blur))
    }

    /// True meters of one length of the range.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Whether caustics show on surfaces.
    #[must_use]
    pub fn draws_caustics(&self) -> bool {
        self.draws_caustics
    }

    /// Whether surfaces occlude the daylight that the veil comes from.
    #[must_use]
    pub fn occludes_veil(&self) -> bool {
        self.occludes_veil
    }

    /// Whether caustics show in the water before surfaces, too.
    #[must_use]
    pub fn has_shafts(&self) -> bool {
        self.has_shafts
    }

    /// The irradiance at the camera over that which is white.
    #[must_use]
    pub fn level(&self) -> [f64; 3] {
        self.level
    }

    /// How the veil depends on the direction.
    #[must_use]
    pub fn veil_form(&self) -> VeilModel {
        self.veil
    }

    /// The radiance field of each channel.
    #[must_use]
    pub fn fields(&self) -> &[Field; 3] {
        &self.fields
    }

    /// Depth of the camera in lengths of the range.
    #[must_use]
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// The same light before a camera with this view.
    #[must_use]
    pub fn seen_by(&self, gaze: Gaze) -> Self {
        Self { gaze, ..*self }
    }

    /// The veil of one channel in water of this attenuation and veiling light at the horizon.
    #[must_use]
    pub fn veil_of(&self, channel: usize, attenuation: f64, horizon_light: f64) -> VeilOf {
        let field = self.fields[channel];
        VeilOf {
            field: Field {
                decay: field.decay.min(MOST_DECAY * attenuation),
                ..field
            },
            attenuation,
            light: horizon_light,
            depth: self.depth,
        }
    }

    /// `B_h = π e Λ`: the radiance of the horizon, where a white horizontal patch at the camera has the radiance e.
    #[must_use]
    pub(crate) fn physical(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| std::f64::consts::PI * self.level[i] * self.fields[i].shape.horizon)
    }
}
