//! Daylight: how bright the water is in every direction, the veil that follows, and the light on surfaces.
//!
//! Radiance in open water is solved by radiative transfer ([`transport`]) once for each channel of a frame and stored in a form
//! that is cheap to evaluate at every pixel ([`field`]). Irradiance falls with depth as `E(z) = E(0) e^{−K z}`, with K chosen to
//! match the solution at the camera.

mod aureole;
mod caustics;
mod conditions;
mod cumulative;
mod field;
mod gaze;
mod limits;
mod model;
mod rises;
mod seen;
mod slope;
mod sun;
mod surface;
mod transport;
mod veil;
mod wide;

pub use caustics::{
    RAYS_PER_CELL, Refraction, Strength, Tiles, Waves, caustics, caustics_reference, shafts, slices,
    tile_reference, with_shafts,
};
pub use conditions::{Blur, Daylight};
pub use field::Field;
pub(crate) use field::{Fields, Place};
pub use gaze::Gaze;
pub use limits::{Heights, MostLight};
pub use model::{
    Bottom, CRITICAL_COSINE, Caustics, DaylightModel, REFRACTIVE_INDEX, Sun, SurfaceLight, fresnel,
};
pub use seen::{
    Surfaces, access, access_reference, occlude_veil, sunlit, sunlit_reference, veil_access,
    veil_access_reference,
};
pub use slope::{SLOPES, share_by_slope};
pub use sun::SunLight;
pub use surface::{Reaching, surfaces, surfaces_reference, with_lamps};
pub use veil::{VeilOf, veil, veil_reference};
pub use wide::WideScattering;

use veil::{SHALLOWEST, SunnyWater};

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
    /// Occlusion of the daylight that causes the veil.
    VeilOcclusion,
}

impl Daylight {
    /// Disables an effect.
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

    /// Its effect on surfaces.
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

    /// The waves of a seed in the frame with this number, and the blur of their pattern by sun and water.
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

    /// Whether surfaces occlude the daylight that causes the veil.
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

    /// The same light with other fields, for tests of surfaces alone.
    #[must_use]
    pub fn with_fields(&self, fields: [Field; 3]) -> Self {
        Self { fields, ..*self }
    }

    /// The veil of one channel.
    #[must_use]
    pub fn veil_of(&self, channel: usize) -> VeilOf {
        VeilOf {
            field: self.fields[channel],
            light: std::f64::consts::PI * self.level[channel],
            depth: self.depth.max(SHALLOWEST),
            below: self.below,
            sun: self.sun.map(|sun| SunnyWater::seen_by(&self.gaze, &sun)),
        }
    }

    /// The share of singly scattered sunlight in the veil of a ray, in the green channel, which stands for all.
    pub(crate) fn sun_share_of_veil(&self, ray: [f64; 3], length: f64) -> f64 {
        let rise = (0..3).map(|axis| ray[axis] * self.gaze.up[axis]).sum();
        let veil = self.veil_of(1);
        let all = veil.at(ray, rise, Some(length));
        let diffuse = VeilOf { sun: None, ..veil }.at(ray, rise, Some(length));
        if all > 0.0 { 1.0 - diffuse / all } else { 0.0 }
    }

    /// Radiance of the horizon, where white is 1.
    #[must_use]
    pub(crate) fn horizon_light(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| std::f64::consts::PI * self.level[i] * self.fields[i].horizon)
    }
}
