use super::*;
use optics::lamp::FournierForand;

fn bench(scattering: f64, cone_deg: Option<f64>) -> Bench {
    Bench {
        water: WaterCoefficients {
            absorption: 0.179,
            scattering,
        },
        cone_deg,
        walls_m: vec![1.0, 3.0, f64::INFINITY],
        looks_deg: vec![0.0, 20.0, -20.0],
        cameras_m: vec![[0.28, 0.32], [0.94, 1.06]],
        rings_deg: vec![10.0, 30.0],
    }
}

/// Single-scattered light of a lamp at the origin along a ray, by the midpoint rule.
fn single(bench: &Bench, phase: &Phase, look_deg: f64, wall: f64, camera: f64) -> f64 {
    let (sin, cos) = look_deg.to_radians().sin_cos();
    let c = bench.water.attenuation();
    let (steps, end) = (200_000, (wall / cos).min(60.0));
    let cone = bench.cone_deg.map(|cone| cone.to_radians().cos());
    let steps_light = |i: usize| {
        let s = end * (i as f64 + 0.5) / steps as f64;
        let (x, z) = (camera + s * sin, s * cos);
        let r = x.hypot(z);
        let profile = cone.map_or(1.0, |cone| ((z / r - cone) / (1.0 - cone)).clamp(0.0, 1.0));
        let cosine = -(x * sin + z * cos) / r;
        profile * phase.density(1.0 - cosine) * (-c * (s + r)).exp() / (r * r)
    };
    bench.water.scattering * (0..steps).map(steps_light).sum::<f64>() * end / steps as f64
}

#[test]
fn what_is_scattered_once_is_the_integral_along_the_ray() {
    let phase = Phase::fournier_forand(FournierForand::of_backscatter(0.0183));
    for cone in [None, Some(35.0)] {
        let bench = bench(0.4, cone);
        let shone = bench.shine(&phase, 1, 0..60_000);
        for (look, degrees) in bench.looks_deg.iter().enumerate() {
            for (wall, meters) in bench.walls_m.iter().enumerate() {
                for (camera, [near, far]) in bench.cameras_m.iter().enumerate() {
                    let traced = shone.airlight[look][wall][camera].single;
                    let exact = single(&bench, &phase, *degrees, *meters, 0.5 * (near + far));
                    // Two percent for the width of camera and disc.
                    let allowed = 4.0 * traced.error + 0.02 * exact + 1e-6;
                    assert!(
                        (traced.mean - exact).abs() <= allowed,
                        "{cone:?} {degrees} {meters} {near}: {traced:?} and {exact}"
                    );
                }
            }
        }
    }
}

#[test]
fn photons_that_are_not_absorbed_all_arrive() {
    let phase = Phase::henyey_greenstein(0.9);
    let bench = Bench {
        water: WaterCoefficients {
            absorption: 0.0,
            scattering: 0.5,
        },
        walls_m: vec![0.5],
        looks_deg: Vec::new(),
        rings_deg: vec![89.9],
        ..bench(0.5, Some(20.0))
    };
    let shone = bench.shine(&phase, 2, 0..4000);
    let [_, outer] = bench.ring_m(0, 0);
    let scattered = shone.scattered[0][0].mean * PI * outer * outer / bench.power();
    // Unscattered light: the profile is linear in the cosine.
    let cone = 20f64.to_radians().cos();
    let steps = 10_000;
    let direct: f64 = (0..steps)
        .map(|i| {
            let x = (i as f64 + 0.5) / steps as f64;
            2.0 * x * (-0.5 * 0.5 / (cone + x * (1.0 - cone))).exp() / steps as f64
        })
        .sum();
    let arrived = scattered + direct;
    assert!((0.97..=1.001).contains(&arrived), "{arrived}");
}
