//! Least shadow quality that the tolerance of a frame requires.
//!
//! A lamp has no shadows if no box of a solid meets the hull of the lamp and the lit region. A soft lamp has hard shadows on
//! surfaces if its widest penumbra, `2 R (r − d)/d` at the distance r from the lamp with the nearest occluder at d, spans less than
//! a pixel. The number of light samples keeps the steps of a penumbra within the tolerance.

use imaging::rays::{Cuboid, Rays};

use crate::lamp::{Lamp, Lighting, Shadow, irradiance_of, places_within};
use crate::visible_bounds::{Region, VisibleBounds};

/// Lamps as a frame needs them to cast shadows.
#[derive(Debug, Clone, PartialEq)]
pub struct Casting {
    /// For their light on surfaces.
    pub on_surfaces: Lighting,
    /// For their airlight.
    pub in_glow: Lighting,
}

impl Casting {
    /// The shadows that a frame of this tolerance in linear light needs of those that its lamps are to cast on a scene with these bounds
    /// and rays.
    #[must_use]
    pub fn needed(tolerance: f64, lighting: &Lighting, view: &VisibleBounds, rays: &dyn Rays) -> Self {
        let visible = irradiance_of(view.brightest(), tolerance);
        let of = |choose: &dyn Fn(&Caster<'_>) -> Shadow| Lighting {
            lamps: (lighting.lamps.iter())
                .map(|lamp| {
                    let caster = Caster {
                        lamp,
                        lighting,
                        view,
                        rays,
                    };
                    lamp.with_shadow(choose(&caster), lamp.casts_into_water())
                })
                .collect(),
            ..lighting.clone()
        };
        Self {
            on_surfaces: of(&|caster| caster.on_surfaces(visible)),
            in_glow: of(&|caster| caster.in_glow()),
        }
    }
}

/// A lamp and the visible regions.
struct Caster<'a> {
    lamp: &'a Lamp,
    lighting: &'a Lighting,
    view: &'a VisibleBounds,
    rays: &'a dyn Rays,
}

impl Caster<'_> {
    /// `visible` is the light on surfaces that the tolerance is.
    fn on_surfaces(&self, visible: f64) -> Shadow {
        let asked = self.lamp.shadow();
        let disc_m = |distance_m: f64| self.lamp.disc_m(self.lighting, distance_m);
        if asked == Shadow::None || !self.may_be_hidden(self.view.surfaces(), disc_m) {
            return Shadow::None;
        }
        match asked {
            Shadow::Soft { radius_m, .. } if self.penumbra_px(radius_m) < 1.0 => Shadow::Hard,
            Shadow::Soft { radius_m, samples } => Shadow::Soft {
                radius_m,
                samples: samples.min(places_within(visible / self.brightest())),
            },
            hard => hard,
        }
    }

    fn in_glow(&self) -> Shadow {
        let asked = self.lamp.shadow();
        let (radius_m, _) = asked.disc();
        if asked == Shadow::None || !self.may_be_hidden(self.view.water(), |_| radius_m) {
            return Shadow::None;
        }
        asked
    }

    /// Whether an occluder is possible for light to points at a distance, from a disc of this radius.
    fn may_be_hidden(&self, mut regions: impl Iterator<Item = Region>, disc_m: impl Fn(f64) -> f64) -> bool {
        regions.any(|region| {
            let [_, farthest] = region.places.distances(self.lamp.position_m());
            let lamp = Cuboid::centered(self.lamp.position_m(), disc_m(farthest));
            self.rays.may_occlude(&region.places, &lamp)
        })
    }

    /// The widest penumbra across its light, in pixels.
    fn penumbra_px(&self, radius_m: f64) -> f64 {
        let place = self.lamp.position_m();
        let clear = self.rays.clearance(place);
        let penumbras = self.view.surfaces().map(|region| {
            let [_, farthest] = region.places.distances(place);
            2.0 * radius_m * (farthest - clear).max(0.0) / clear * region.px_per_m
        });
        penumbras.fold(0.0, f64::max)
    }

    /// Upper bound of the light on a surface.
    fn brightest(&self) -> f64 {
        let light = self.view.surfaces().map(|region| {
            let [nearest, _] = region.places.distances(self.lamp.position_m());
            self.lamp.most_light(self.lighting, nearest)
        });
        light.fold(0.0, f64::max)
    }
}
