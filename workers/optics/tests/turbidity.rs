//! Paths through patchy water: the closed form against quadrature, and the chain's bound with them.
#![allow(clippy::unwrap_used)]

use fathom_optics::eye::Eye;
use fathom_optics::range::{HoleRule, is_hole};
use fathom_optics::snow::World;
use fathom_optics::turbidity::{Turbidity, optical_path, optical_path_reference, path_rounding};
use imaging::Plane;
use imaging::geometry::Intrinsics;

const SIZES: [(usize, usize); 6] = [(1, 1), (1, 9), (7, 1), (13, 17), (31, 8), (67, 41)];

fn eye(size: (usize, usize)) -> Eye {
    Eye {
        camera: Intrinsics::centred(0.7 * size.0 as f64, size.0, size.1),
        world_from_camera: [
            [0.0, -0.6, 0.8, 400.0],
            [1.0, 0.0, 0.0, -200.0],
            [0.0, 0.8, 0.6, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
    }
}

/// From a millimetre to a kilometre, with holes.
fn range(width: usize, height: usize, scale: f32) -> Plane<f32> {
    Plane::from_fn(width, height, |x, y| match (x, y) {
        (0, 0) => f32::INFINITY,
        (2, 1) => f32::NAN,
        (3, 1) => 0.0,
        (4, 1) => 1.1e-3,
        _ => scale * (0.8 + 0.05 * x as f32 + 0.1 * y as f32),
    })
}

#[test]
fn paths_agree_with_the_quadrature() {
    for size in SIZES {
        let eye = eye(size);
        for (contrast, scale_m) in [(0.3, 0.05), (0.95, 0.7), (0.5, 20.0), (0.9, 1000.0)] {
            let turbidity = Turbidity { contrast, scale_m };
            let field = turbidity.field(World { seed: 9, index: 4 });
            let farthest = if size.0 < 20 { 30.0 } else { 2.0 };
            for scale in [0.01, 1.0, farthest] {
                let range = range(size.0, size.1, scale);
                for holes in [HoleRule::Background, HoleRule::Range(12.0)] {
                    let fast = optical_path(&range, &field, &eye, holes);
                    let exact =
                        optical_path_reference(&range.map(|&z| z.into()), &turbidity, &field, &eye, holes);
                    let triples = fast.data().iter().zip(exact.data()).zip(range.data());
                    for ((&fast, &exact), &z) in triples {
                        assert_eq!(is_hole(fast), is_hole(exact));
                        if is_hole(exact) {
                            continue;
                        }
                        let longest = if is_hole(z) { 12.0 } else { f64::from(z) }.max(exact);
                        let error = (f64::from(fast) - exact).abs();
                        assert!(
                            error <= path_rounding(longest, scale_m) * longest,
                            "{size:?}, {turbidity:?}, {z} m: {fast} for {exact}, {:e}",
                            error / longest
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_scalar_form_is_the_quadrature_too() {
    let turbidity = Turbidity {
        contrast: 0.95,
        scale_m: 0.4,
    };
    let field = turbidity.field(World { seed: 2, index: 0 });
    let eye = eye((31, 17));
    let range = Plane::filled(31, 17, 6.5f64);
    let exact = optical_path_reference(&range, &turbidity, &field, &eye, HoleRule::Background);
    let seen = field.seen_from(&eye);
    for (x, y) in [(0, 0), (15, 8), (30, 16)] {
        let ray = [(x as f64 - 15.0) / 21.7, (y as f64 - 8.0) / 21.7, 1.0];
        let length = ray.iter().map(|v| v * v).sum::<f64>().sqrt();
        let path = seen.path_m(ray.map(|v| v / length), 6.5);
        assert!((path - exact.at(x, y)).abs() < 1e-9, "{path} {}", exact.at(x, y));
    }
}
