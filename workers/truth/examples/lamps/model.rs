//! The light of the chain at the positions of a measurement.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use optics::lamp::{
    GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, airlight_reference, asymmetry_of,
    irradiance_reference,
};
use truth::light_tracer::Bench;

/// b_b/b of all waters.
pub(super) const BACKSCATTER: f64 = 0.0183;
/// Circles for averaging the light of a ring.
const CIRCLES: usize = 16;

/// A lamp in a water, as modeled by the chain.
pub(super) struct Model {
    absorption: f64,
    scattering: f64,
    cone_deg: Option<f64>,
}

impl Model {
    pub(super) fn new(bench: &Bench) -> Self {
        Self {
            absorption: bench.water.absorption,
            scattering: bench.water.scattering,
            cone_deg: bench.cone_deg,
        }
    }

    /// The light with single scattering, with multiple scattering, and with a phase function that rises toward the back.
    fn render_variants(&self, lamp_x: f64, ray_slope: f64, light: impl Fn(&Lighting) -> f64) -> [f64; 3] {
        let position_m = [lamp_x, 0.0, 0.0];
        let lamp = match self.cone_deg {
            None => Lamp::point(position_m, [1.0; 3]),
            Some(cone) => Lamp::spot(position_m, [1.0; 3], [0.0, 0.0, 1.0], cone),
        };
        let lighting = Lighting {
            lamps: lamp.into_iter().collect(),
            radius_m: LAMP_RADIUS_M,
            camera: Intrinsics {
                focal_px: 1.0,
                cx: -ray_slope,
                cy: 0.0,
            },
            attenuation: [self.absorption + self.scattering; 3],
            scattering: [self.scattering; 3],
            phase: GlowPhase::henyey_greenstein(asymmetry_of(BACKSCATTER)),
            absorption: None,
            patches: None,
        };
        let followed = Lighting {
            absorption: Some([self.absorption; 3]),
            ..lighting.clone()
        };
        let rising = Lighting {
            phase: GlowPhase::fournier_forand(BACKSCATTER),
            ..followed.clone()
        };
        [light(&lighting), light(&followed), light(&rising)]
    }

    /// The airlight seen by a camera next to the lamp.
    pub(super) fn airlight(&self, camera_m: f64, look_deg: f64, wall_m: f64) -> [f64; 3] {
        let look = look_deg.to_radians();
        let range = Plane::filled(1, 1, wall_m / look.cos());
        self.render_variants(-camera_m, look.tan(), |lighting| {
            airlight_reference(&range, lighting, REFERENCE_NODES).planes()[0].pixel(0, 0)
        })
    }

    /// The mean light on a ring of a wall.
    pub(super) fn surface(&self, [inner, outer]: [f64; 2], wall_m: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let normal = [0.0f32, 0.0, -1.0].map(|v| Plane::filled(1, 1, v));
        for circle in 0..CIRCLES {
            // The circle splits its share of the ring into equal areas.
            let share = (circle as f64 + 0.5) / CIRCLES as f64;
            let radius = (inner * inner + share * (outer * outer - inner * inner)).sqrt();
            let range = Plane::filled(1, 1, wall_m.hypot(radius));
            let light = self.render_variants(0.0, radius / wall_m, |lighting| {
                irradiance_reference(&range, &normal, lighting).planes()[0].pixel(0, 0)
            });
            sum = [0, 1, 2].map(|i| sum[i] + light[i] / CIRCLES as f64);
        }
        sum
    }
}
