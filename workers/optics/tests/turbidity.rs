//! Paths through patchy water: the closed form against quadrature, and the chain's bound with them.
#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use optics::chain::{water, water_reference};
use optics::eye::Eye;
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::range::is_hole;
use optics::snow::World;
use optics::turbidity::{Field, optical_path, optical_path_reference, path_rounding};
use optics::water::Water;
use spec::{Fidelity, HoleRule, Optics, Turbidity};

const SIZES: [(usize, usize); 6] = [(1, 1), (1, 9), (7, 1), (13, 17), (31, 8), (37, 23)];

fn eye(size: (usize, usize)) -> Eye {
    Eye {
        camera: Intrinsics::centered(0.7 * size.0 as f64, size.0, size.1),
        world_from_camera: [
            [0.0, -0.6, 0.8, 400.0],
            [1.0, 0.0, 0.0, -200.0],
            [0.0, 0.8, 0.6, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
    }
}

/// From a millimeter to a kilometer, with holes.
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
            let field = Field::new(&turbidity, World { seed: 9, index: 4 });
            let farthest = if size.0 < 20 { 30.0 } else { 2.0 };
            for scale in [0.01, 1.0, farthest] {
                let range = range(size.0, size.1, scale);
                for holes in [HoleRule::Background, HoleRule::RangeM(12.0)] {
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
    let field = Field::new(&turbidity, World { seed: 2, index: 0 });
    let eye = eye((31, 17));
    let range = Plane::filled(31, 17, 6.5f64);
    let exact = optical_path_reference(&range, &turbidity, &field, &eye, HoleRule::Background);
    let seen = field.seen_from(&eye);
    for (x, y) in [(0, 0), (15, 8), (30, 16)] {
        let ray = [(x as f64 - 15.0) / 21.7, (y as f64 - 8.0) / 21.7, 1.0];
        let length = ray.iter().map(|v| v * v).sum::<f64>().sqrt();
        let path = seen.path_m(ray.map(|v| v / length), 6.5);
        assert!(
            (path - exact.pixel(x, y)).abs() < 1e-9,
            "{path} {}",
            exact.pixel(x, y)
        );
    }
}

/// The plan made for the paths bounds the whole error against the reference in f64 of paths and chain.
#[test]
fn the_plan_bounds_the_chain_in_patchy_water() {
    let size = (48, 31);
    let eye = eye(size);
    let request = Medium::from(Optics {
        preset: Some("jerlov-3C".to_owned()),
        ..Optics::default()
    });
    let optics = Water::resolve(&request, eye.camera.focal_px).unwrap();
    let radiance = Rgb::from_fn(size.0, size.1, |x, y| {
        let stripe = if (x / 5 + y / 4) % 2 == 0 { 0.9 } else { 0.05 };
        [stripe, 0.7 * stripe, 0.95 - stripe]
    });
    let range = range(size.0, size.1, 1.0);
    for (contrast, scale_m) in [(0.5, 3.0), (0.95, 0.5)] {
        let turbidity = Turbidity { contrast, scale_m };
        let field = Field::new(&turbidity, World { seed: 4, index: 1 });
        let exact_path = optical_path_reference(
            &range.map(|&z| z.into()),
            &turbidity,
            &field,
            &eye,
            HoleRule::Background,
        );
        let exact = water_reference(&radiance.map(|&j| j.into()), &exact_path, &optics).unwrap();
        let path = optical_path(&range, &field, &eye, HoleRule::Background);
        for tolerance in [1e-2, 3e-4, 3e-5] {
            let stats = SceneBounds::measure(&radiance, &path, &optics);
            let plan = Plan::for_water(&stats, &optics, Fidelity::Tolerance(tolerance));
            let fast = water(&radiance, &path, &optics, &plan, &mut KernelCache::new()).unwrap();
            let farthest = stats.range_m.unwrap().1;
            let rounding = 2.0 * path_rounding(farthest, scale_m) / std::f64::consts::E;
            for (channel, error) in plan.errors().into_iter().enumerate() {
                let brightest = exact.scattered.planes()[channel]
                    .data()
                    .iter()
                    .copied()
                    .fold(0.0, f64::max);
                let bound = error.bound_sample(brightest);
                let pairs = fast.scattered.planes()[channel].data().iter();
                let worst = pairs
                    .zip(exact.scattered.planes()[channel].data())
                    .map(|(&fast, exact)| (f64::from(fast) - exact).abs())
                    .fold(0.0, f64::max);
                assert!(
                    worst <= bound + rounding,
                    "{turbidity:?}, {tolerance:e}, channel {channel}: {worst:e} > {bound:e} + {rounding:e}"
                );
            }
        }
    }
}
