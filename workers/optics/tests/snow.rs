//! The fast form of snow agrees with its f64 reference: size × scene × tolerance.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use optics::eye::Eye;
use optics::snow::{Flake, Seeing, Surround, World, flakes, is_in_front, lit, snow, snow_reference};
use spec::Snow;

/// f32 over up to some thousand faint layers on one pixel, as tiny frames have them: at most 6e-8 for each, of either sign.
const ROUNDING: f64 = 1e-5;
const SIZES: [(usize, usize); 6] = [(1, 1), (1, 9), (7, 1), (13, 17), (31, 8), (48, 29)];

/// Typical snow, dust, flakes, and a storm of large ones close by.
const SNOWS: [(&str, Snow); 4] = [
    (
        "blurred and drawn-out aggregates",
        Snow {
            near_m: 0.1,
            far_m: 3.0,
            radius_m: 6e-4,
            spectrum: 3.0,
            aggregates: 0.4,
            drift_m_per_s: Some([0.3, -0.1, 0.2]),
            ..Snow::with_density(200.0)
        },
    ),
    (
        "dust",
        Snow {
            density_per_m3: 800.0,
            near_m: 0.1,
            far_m: 4.0,
            radius_m: 2e-4,
            albedo: [0.9, 0.8, 0.7],
            ..Snow::with_density(0.0)
        },
    ),
    (
        "flakes",
        Snow {
            density_per_m3: 300.0,
            near_m: 0.1,
            far_m: 3.0,
            radius_m: 1e-3,
            albedo: [0.5; 3],
            ..Snow::with_density(0.0)
        },
    ),
    (
        "storm",
        Snow {
            density_per_m3: 900.0,
            near_m: 0.05,
            far_m: 2.0,
            radius_m: 3e-3,
            albedo: [1.0; 3],
            ..Snow::with_density(0.0)
        },
    ),
];

/// A slope with a step, a hole and an open corner.
fn range(width: usize, height: usize) -> Plane<f32> {
    Plane::from_fn(width, height, |x, y| match (x, y) {
        (0, 0) => f32::INFINITY,
        (2, 1) => f32::NAN,
        _ if x > width / 2 => 0.8 + 0.01 * y as f32,
        _ => 2.0 + 0.05 * x as f32 + 0.1 * y as f32,
    })
}

#[test]
fn snow_stays_within_its_tolerance_of_the_reference() {
    let (mut drawn, mut hidden) = (0, 0);
    for size in SIZES {
        let range = range(size.0, size.1);
        let eye = Eye::at_origin(Intrinsics::centered(
            0.7 * size.0.max(size.1) as f64,
            size.0,
            size.1,
        ));
        // A lens that sees 1.5 m sharply, in a sixtieth of a second.
        let seeing = Seeing {
            blur_px: &|range| (0.02 * eye.camera.focal_px * (1.0 / range - 1.0 / 1.5)).abs(),
            exposure_s: 1.0 / 60.0,
            time_s: 0.3,
        };
        for (name, law) in SNOWS {
            for attenuation in [[0.0; 3], [0.6, 0.2, 0.1]] {
                let found: Vec<Flake> = flakes(&eye, &law, World { seed: 5, index: 2 }, size, &seeing);
                drawn += found.len();
                let surround = Surround {
                    range: &range,
                    eye: &eye,
                    attenuation,
                    path: &|_, range| 1.2 * range,
                    // A lamp next to the camera.
                    light: &|points| {
                        let light = |[x, y, z]: [f64; 3]| {
                            [0.4 + 0.05 / ((x - 0.2).powi(2) + y * y + z * z).max(0.02); 3]
                        };
                        points.iter().map(|point| light(point.place)).collect()
                    },
                };
                let image = Rgb::from_fn(size.0, size.1, |x, y| [0.02 * x as f32, 0.3, 0.01 * y as f32]);
                let (exact, exact_mask) =
                    snow_reference(&image.map(|&v| f64::from(v)), &found, law.albedo, &surround);
                let mut visible = found.clone();
                visible.retain(|flake| is_in_front(flake, &range));
                hidden += found.len() - visible.len();
                let lit = lit(&visible, law.albedo, &surround);
                for tolerance in [1e-2, 3e-4, 1e-6] {
                    let mut fast = image.clone();
                    let mask = snow(&mut fast, &lit, &range, tolerance);
                    let picture = fast.planes().iter().zip(exact.planes());
                    let picture =
                        worst(picture.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data())));
                    // Green is at least 0.3 everywhere, which limits the omitted opacity.
                    let mask = worst(mask.data().iter().zip(exact_mask.data()));
                    assert!(
                        picture <= tolerance + ROUNDING && mask <= tolerance / 0.3 + ROUNDING,
                        "{name}, {size:?}, {attenuation:?}, {tolerance:e}: {picture:e}, mask {mask:e}"
                    );
                }
            }
        }
    }
    assert!(
        drawn > 5_000 && hidden > 100,
        "{drawn} particles, {hidden} behind surfaces"
    );
}

fn worst<'a>(pairs: impl Iterator<Item = (&'a f32, &'a f64)>) -> f64 {
    pairs
        .map(|(&fast, exact)| (f64::from(fast) - exact).abs())
        .fold(0.0, |worst, error| if error <= worst { worst } else { error })
}
