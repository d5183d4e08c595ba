//! The chain's light of a lamp in a frame with a box and a wall against the stored truth: the improvement by each
//! effect.

use std::path::Path;

use imaging::geometry::Intrinsics;
use imaging::rays::Rays;
use imaging::vector::DVec3;
use imaging::{Plane, Rgb};
use optics::lamp::{
    self, GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, Shadow, airlight_reference, asymmetry_of,
};

use crate::golden::Case;
use crate::support::{Solids, TestSolid};

/// b_b/b of the stored frame's phase function.
const BACKSCATTER: f64 = 0.0183;
/// A share b/20 of the scattering leaves the picture; the rest is forward scatter, counted here at its origin.
const LOST: f64 = 0.05;
/// The frame's mean is known to 0.4 % and the formulas of all orders are fits to about a tenth; the published means
/// have two digits.
const TOLERANCE: f64 = 0.02;

/// Geometry of the frame.
struct Frame {
    case: Case,
    solids: Solids,
    camera: Intrinsics,
    range: Plane<f64>,
    normals: [Plane<f32>; 3],
}

impl Frame {
    fn read() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/realism/mc-lamp-box");
        let case = Case::read(&folder);
        let solids = Solids(vec![
            TestSolid::Wall(case.number("/wall_z")),
            TestSolid::Block {
                low: case.triple("/box_lo"),
                high: case.triple("/box_hi"),
            },
        ]);
        let (width, height) = (case.number("/width") as usize, case.number("/height") as usize);
        let camera = Intrinsics::centered(case.number("/focal_px"), width, height);
        let met = |x: usize, y: usize| {
            let ray = DVec3::from(camera.ray(x as f64, y as f64)).normalized();
            let hit = solids.hit([0.0; 3], ray.into(), 0.0, f64::INFINITY);
            hit.expect("the wall is behind everything")
        };
        Self {
            range: Plane::from_fn(width, height, |x, y| met(x, y).distance),
            normals: [0, 1, 2].map(|i| Plane::from_fn(width, height, |x, y| met(x, y).normal[i] as f32)),
            camera,
            solids,
            case,
        }
    }

    fn lighting(&self, shadow: Shadow, follows: bool) -> Lighting {
        let case = &self.case;
        let (a, b) = (case.number("/absorption"), case.number("/scattering"));
        let spot = Lamp::spot(
            case.triple("/lamp/position_m"),
            [case.number("/lamp/intensity"); 3],
            case.triple("/lamp/direction"),
            case.number("/lamp/cone_deg"),
        );
        Lighting {
            lamps: vec![spot.expect("a lamp").with_shadow(shadow, true)],
            radius_m: LAMP_RADIUS_M,
            camera: self.camera,
            attenuation: [a + b; 3],
            scattering: [b; 3],
            absorption: follows.then_some([a; 3]),
            phase: GlowPhase::henyey_greenstein(asymmetry_of(BACKSCATTER)),
            patches: None,
        }
    }

    /// Mean of the chain's light over that of the truth, with this attenuation of surface light.
    fn share(&self, lighting: &Lighting, attenuation: f64) -> f64 {
        let casts = lighting.lamps[0].shadow() != Shadow::None;
        let rays = &self.solids;
        let (surfaces, glow): (Rgb<f64>, Rgb<f64>) = if casts {
            (
                lamp::shaded_irradiance_reference(&self.range, &self.normals, lighting, rays),
                lamp::shaded_airlight_reference(&self.range, lighting, REFERENCE_NODES, rays),
            )
        } else {
            (
                lamp::irradiance_reference(&self.range, &self.normals, lighting),
                airlight_reference(&self.range, lighting, REFERENCE_NODES),
            )
        };
        let albedo = self.case.number("/albedo") / std::f64::consts::PI;
        let pixels = self.range.data().iter().zip(surfaces.planes()[0].data());
        let pixels = pixels.zip(glow.planes()[0].data());
        let sum: f64 = pixels
            .map(|((z, light), glow)| albedo * light * (-attenuation * z).exp() + glow)
            .sum();
        sum / self.case.array("total").iter().sum::<f64>()
    }
}

#[test]
fn each_effect_of_lamps_brings_the_mean_of_the_chain_to_where_it_was_published() {
    let frame = Frame::read();
    let (a, b) = (frame.case.number("/absorption"), frame.case.number("/scattering"));
    let arriving = a + LOST * b;
    let rungs = [
        ("direct light and glow", Shadow::None, false, a + b, 0.53),
        ("with forward scatter", Shadow::None, false, arriving, 0.73),
        ("with shadows", Shadow::Hard, false, arriving, 0.70),
        (
            "with shadows and multiple scattering",
            Shadow::Hard,
            true,
            arriving,
            1.03,
        ),
    ];
    let shares = rungs.map(|(what, shadow, follows, attenuation, published)| {
        let share = frame.share(&frame.lighting(shadow, follows), attenuation);
        (what, share, published)
    });
    println!("   {shares:?}");
    for (what, share, published) in shares {
        assert!(
            (share - published).abs() <= TOLERANCE,
            "{what}: {share}, published {published}"
        );
    }
}
