//! Lamps in the water: point and spot lamps, their light on surfaces and their airlight.
//!
//! A lamp of intensity I₀ per steradian at P lights a point X at the distance r = |X − P| with `E = I₀ S e^{−c r} max(n·l, 0) /
//! r²`. The surface reflects J E / π, which propagates through the water like other light of the scene. Single scattering of lamp
//! light into the ray is the airlight, see [`airlight`] (Jaffe 1990; Sun, Ramamoorthi, Narasimhan, Nayar 2005). S is 1, or the
//! profile of a spot, `clamp((cos − cos cone)/(1 − cos cone), 0, 1)` about its axis. The camera looks along z, x is right and y is
//! down. Multiple scattering is added in closed form if the absorption is known, see `multiple`; without it a lamp on a wall 4 m
//! away is 2 times too dark in coastal water and 12 times in 3C. A lamp has a shadow mode ([`Shadow`]); occlusion is found by rays
//! through the scene.
//!
//! In patches of turbidity b and c are multiplied by means of the field along the ray. For the airlight, b is averaged over the
//! stretch of [`glow_within`], the source of most of it, and c from the camera to its end. For the path to a surface, c is averaged
//! over the same length of the camera ray before it. The field along both legs of every node would cost a hundred times more.

mod airlight;
mod beam;
mod beyond;
mod blurred;
mod bounds;
mod coarse;
mod multiple;
mod nodes;
mod normals;
mod particles;
mod patches;
mod phase;
mod point;
mod reference;
mod shadow;
mod sight;
mod surface;

pub use airlight::{Airlight, airlight, airlight_with_nodes, airlight_within, shaded_airlight};
pub use beyond::most_white_beyond;
pub use bounds::{AirlightBounds, SurfaceBounds, bound_airlight, bound_irradiance};
pub use nodes::MOST_NODES;
pub use normals::normals_of;
pub use particles::FournierForand;
pub use patches::glow_within;
pub use phase::{
    AVERAGE_BACKSCATTER_FRACTION, GlowPhase, asymmetry_of, backscatter_fraction, henyey_greenstein,
};
pub use point::{most_white, white_at, white_at_each};
pub use reference::{
    REFERENCE_NODES, airlight_reference, irradiance_reference, shaded_airlight_reference,
    shaded_irradiance_reference,
};
pub use shadow::Shadow;
pub(crate) use shadow::places_within;
pub use surface::{
    Irradiance, LIT_ROUNDING, irradiance, irradiance_in_tiles, irradiance_of, lit, lit_rounding,
    shaded_irradiance, shaded_irradiance_in_tiles,
};

pub use crate::legendre::gauss_legendre;

use imaging::geometry::Intrinsics;
use imaging::vector::dot;
use spec::{Beyond, Light, PointLamp, SpotLamp};

use crate::turbidity::Field;
use beam::Beam;

/// Radius of a lamp in meters. Distances to the lamp are clamped to it, so that its light is bounded.
pub const LAMP_RADIUS_M: f64 = 0.02;
/// The direction of a shorter axis is undefined.
const SHORTEST_AXIS: f64 = 1e-6;

/// A lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    position_m: [f64; 3],
    intensity: [f64; 3],
    beam: Beam,
    shadow: Shadow,
    glow_shadow: bool,
}

impl Lamp {
    /// A lamp without shadow that shines in all directions. `position_m` in meters (right, down, ahead of the camera), `intensity` in
    /// linear radiance times m² for red, green and blue.
    ///
    /// # Errors
    /// Every number beyond its limits.
    pub fn point(position_m: [f64; 3], intensity: [f64; 3]) -> Result<Self, Vec<Beyond>> {
        Self::of_point(&PointLamp {
            position_m,
            intensity,
            radius_m: 0.0,
        })
    }

    fn of_point(lamp: &PointLamp) -> Result<Self, Vec<Beyond>> {
        let beyond = spec::beyond(lamp);
        if !beyond.is_empty() {
            return Err(beyond);
        }
        Ok(Self {
            position_m: lamp.position_m,
            intensity: lamp.intensity,
            beam: Beam::Point,
            shadow: Shadow::None,
            glow_shadow: false,
        })
    }

    /// A lamp without shadow that shines about `direction`, of any length but 0, within `cone_deg` degrees on each side of it.
    ///
    /// # Errors
    /// Every number beyond its limits.
    pub fn spot(
        position_m: [f64; 3],
        intensity: [f64; 3],
        direction: [f64; 3],
        cone_deg: f64,
    ) -> Result<Self, Vec<Beyond>> {
        Self::of_spot(&SpotLamp {
            position_m,
            intensity,
            direction,
            cone_deg,
            radius_m: 0.0,
        })
    }

    fn of_spot(lamp: &SpotLamp) -> Result<Self, Vec<Beyond>> {
        let SpotLamp {
            position_m,
            intensity,
            direction,
            cone_deg,
            ..
        } = *lamp;
        let mut beyond = spec::beyond(lamp);
        let length = direction.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length < SHORTEST_AXIS {
            beyond.push(Beyond {
                field: "direction",
                part: None,
                value: length,
                limit: format!("a length of at least {SHORTEST_AXIS:e}"),
            });
        }
        if !beyond.is_empty() {
            return Err(beyond);
        }
        let axis = direction.map(|v| v / length);
        let cos_cone = cone_deg.to_radians().cos().max(0.0);
        Ok(Self {
            position_m,
            intensity,
            beam: Beam::Spot { axis, cos_cone },
            shadow: Shadow::None,
            glow_shadow: false,
        })
    }

    /// The same lamp with this shadow mode on surfaces, and in the water too if `glow` is true.
    #[must_use]
    pub fn with_shadow(self, shadow: Shadow, glow: bool) -> Self {
        Self {
            shadow,
            glow_shadow: glow && shadow != Shadow::None,
            ..self
        }
    }

    /// The same lamp in the axes of a camera this many meters to the right.
    #[must_use]
    pub fn seen_from_right(self, right_m: f64) -> Self {
        let [x, y, z] = self.position_m;
        Self {
            position_m: [x - right_m, y, z],
            ..self
        }
    }

    /// The lamps among the lights of a frame, in their order, with their shadows on surfaces.
    ///
    /// # Errors
    /// Everything that is wrong with them, such as a direction of length 0 that laws have yielded.
    pub fn among(lights: &[Light]) -> Result<Vec<Self>, Vec<Beyond>> {
        let (mut lamps, mut errors) = (Vec::new(), Vec::new());
        for light in lights {
            match light {
                Light::Haze(_) => continue,
                Light::Point(lamp) => {
                    Self::of_point(lamp).map(|bare| bare.with_shadow(Shadow::of_lamp(lamp.radius_m), false))
                }
                Light::Spot(lamp) => {
                    Self::of_spot(lamp).map(|bare| bare.with_shadow(Shadow::of_lamp(lamp.radius_m), false))
                }
            }
            .map_or_else(|wrong| errors.extend(wrong), |lamp| lamps.push(lamp));
        }
        if errors.is_empty() { Ok(lamps) } else { Err(errors) }
    }

    /// Where it is, in meters: right, down, ahead of the camera.
    #[must_use]
    pub fn position_m(&self) -> [f64; 3] {
        self.position_m
    }

    /// Its shadow mode on surfaces.
    #[must_use]
    pub fn shadow(&self) -> Shadow {
        self.shadow
    }

    /// Whether occluders cast shadows into its airlight, too.
    #[must_use]
    pub fn casts_into_water(&self) -> bool {
        self.glow_shadow
    }

    /// Radius of the disc about the lamp that lights points at a distance: the lamp's radius, widened by the light scattered on its
    /// path.
    pub(crate) fn disc_m(&self, lighting: &Lighting, distance_m: f64) -> f64 {
        let (own, _) = self.shadow.disc();
        if lighting.absorption.is_none() {
            return own;
        }
        let murkiest = lighting.patches.as_ref().map_or(1.0, |field| field.extremes().1);
        let scattering = lighting.scattering.into_iter().fold(0.0, f64::max);
        own.max(distance_m * multiple::surface_scale(scattering * murkiest * distance_m))
    }

    /// Upper bound of the light on surfaces at this distance or farther: `I₀ e^{−c r}/r²`, with a in place of c if multiple
    /// scattering is modeled.
    pub(crate) fn most_light(&self, lighting: &Lighting, distance_m: f64) -> f64 {
        let distance = distance_m.max(lighting.radius_m);
        let clearest = lighting.patches.as_ref().map_or(1.0, |field| field.extremes().0);
        let lost = lighting.absorption.unwrap_or(lighting.attenuation);
        let of = |i: usize| self.intensity[i] * (-lost[i] * clearest * distance).exp();
        [0, 1, 2].map(of).into_iter().fold(0.0, f64::max) / (distance * distance)
    }

    /// Whether it shines about an axis.
    pub(crate) fn is_spot(&self) -> bool {
        matches!(self.beam, Beam::Spot { .. })
    }

    /// Its distance from the camera, m.
    pub(crate) fn distance_m(&self) -> f64 {
        dot(self.position_m, self.position_m).sqrt()
    }
}

/// Lamps, their camera, and the water between. Coefficients in 1/m for red, green and blue.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// The lamps.
    pub lamps: Vec<Lamp>,
    /// Lower limit of the distance to a lamp, m.
    pub radius_m: f64,
    /// The camera.
    pub camera: Intrinsics,
    /// Beam attenuation c.
    pub attenuation: [f64; 3],
    /// Scattering b.
    pub scattering: [f64; 3],
    /// Absorption a if multiple scattering is modeled; `None`: multiply scattered light is lost.
    pub absorption: Option<[f64; 3]>,
    /// The phase function of the airlight.
    pub phase: GlowPhase,
    /// Patches of turbidity in camera axes; `None` in even water.
    pub patches: Option<Field>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_wrong_with_a_lamp_is_said_at_once() {
        let errors = Lamp::spot([0.0, f64::NAN, 0.0], [1.0, -1.0, 1.0], [0.0; 3], 120.0).unwrap_err();
        let fields: Vec<_> = errors.iter().map(|error| error.field).collect();
        assert_eq!(fields, ["position_m", "intensity", "cone_deg", "direction"]);
        assert_eq!(errors[2].to_string(), "cone_deg is 120; must be 0.5..=90");
    }
}
