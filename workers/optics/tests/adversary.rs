//! All frames stay within the bound of their plan, including adversarial ones.
#![allow(clippy::unwrap_used)]

#[path = "adversary/frames.rs"]
mod frames;

use frames::{Attack, Frame};
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::plan::{Plan, SceneBounds};
use spec::{Fidelity, ScatterModel};

/// Side of the frames, pixels.
const SIDE: usize = 72;

/// A bound this far above the worst frame would waste kernels, or the frames would be a weak attack.
const LOOSEST: f64 = 2.0;

fn attack(model: ScatterModel, cases: &[((f64, f64), f64)]) {
    for &(widths_px, tolerance) in cases {
        let mut most = 0.0f64;
        for (target, brighter) in [
            ((SIDE / 2, SIDE / 2), true),
            ((SIDE / 2, SIDE / 2), false),
            ((0, SIDE / 2), false),
        ] {
            let attack = Attack {
                model,
                size: (SIDE, SIDE),
                target,
                widths_px,
                tolerance,
                brighter,
            };
            let frame = attack.frame().unwrap();
            let (bound, error) = bound_and_error(&frame, tolerance);
            assert!(error <= bound, "{attack:?}: {error:e} above {bound:e}");
            assert!(bound <= tolerance, "{attack:?}: {bound:e}");
            most = most.max(error / bound);
        }
        assert!(
            most * LOOSEST >= 1.0,
            "{model:?}, {widths_px:?}, {tolerance:e}: {most}"
        );
    }
}

/// The bound of a plan for this tolerance, and the largest error.
fn bound_and_error(frame: &Frame, tolerance: f64) -> (f64, f64) {
    let Frame {
        radiance,
        range,
        water,
    } = frame;
    let stats = SceneBounds::measure(radiance, range, water);
    let plan = Plan::for_water(&stats, water, Fidelity::Tolerance(tolerance));
    let fast = chain::water(radiance, range, water, &plan, &mut KernelCache::new()).unwrap();
    let (exact_radiance, exact_range) = (radiance.map(|&j| f64::from(j)), range.map(|&z| f64::from(z)));
    let exact = chain::water_reference(&exact_radiance, &exact_range, water).unwrap();
    let [fast, exact] = [
        fast.scattered.planes()[1].map(|&v| f64::from(v)),
        exact.scattered.planes()[1].clone(),
    ];
    let pairs = fast.data().iter().zip(exact.data());
    let error = pairs
        .map(|(fast, exact)| (fast - exact).abs())
        .fold(0.0, f64::max);
    let brightest = exact.data().iter().copied().fold(0.0, f64::max);
    (plan.errors()[1].bound_sample(brightest), error)
}

/// With the previous bound `min(1.2 worst, 2.6 even)` these frames exceeded it by up to 1.29 times.
#[test]
fn light_of_the_worst_scale_at_every_offset_stays_within_the_bound() {
    attack(
        ScatterModel::Jaffe,
        &[
            ((0.02, 100.0), 5e-3),
            ((0.02, 100.0), 1e-3),
            ((0.1, 40.0), 2e-2),
            ((0.1, 40.0), 3e-4),
        ],
    );
}

#[test]
fn a_picture_of_the_signs_of_the_error_stays_within_the_bound() {
    attack(
        ScatterModel::Simplified,
        &[((0.02, 100.0), 5e-3), ((0.1, 40.0), 3e-4)],
    );
}
