//! Range profiles that the model or its interpolation handles badly.

use std::f64::consts::{FRAC_2_PI, PI};

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::forward_scatter::{KernelCache, Nodes, gather, scatter, widest_px};
use spec::{Fidelity, ScatterModel};

use super::finding::Finding;
use super::trial::{DEFAULT, PLENTY, TOLERANCE, Trial, coastal, noise};
use crate::statistics::largest;

/// Two walls side by side.
fn step((width, height): (usize, usize), near: f32, far: f32) -> Plane<f32> {
    Plane::from_fn(width, height, |x, _| if x < width / 2 { near } else { far })
}

/// Noise on a wall at 2 m next to one at 15 m. A few ranges on each side; otherwise one kernel per range would be exact.
fn step_trial(model: ScatterModel, size: (usize, usize)) -> Trial {
    Trial {
        radiance: noise(size),
        range: Plane::from_fn(size.0, size.1, |x, y| {
            step(size, 2.0, 15.0).pixel(x, y) * (1.0 + 0.01 * (y % 24) as f32)
        }),
        water: coastal(model, 0.7),
    }
}

/// The largest change of a uniform field.
fn change(plane: &Plane<f32>, from: f32) -> f64 {
    largest(plane.data().iter().map(|v| f64::from((v - from).abs())))
}

/// A step in range, with very different kernels on both sides.
pub(super) fn measure_step() -> Finding {
    let size = (72, 48);
    let uniform = Plane::filled(size.0, size.1, 0.5f32);
    let gamma = step(size, 1.0, 7.5);
    let nodes = Nodes::exact([1.0, 7.5]);
    let cache = &mut KernelCache::new();
    let scattered = scatter(&uniform, &gamma, &nodes, cache);
    let gathered = gather(&uniform, &gamma, &nodes, cache);
    let jaffe = step_trial(ScatterModel::Jaffe, size);
    let simplified = step_trial(ScatterModel::Simplified, size);
    Finding::default()
        .at_most("error, jaffe", jaffe.error(DEFAULT), TOLERANCE)
        .at_most("error, simplified", simplified.error(DEFAULT), TOLERANCE)
        .at_most("error, 4 kernels", jaffe.error(Fidelity::Terms(4)), 3.5e-3)
        .at_most("error, 8 kernels", jaffe.error(Fidelity::Terms(8)), 9e-5)
        .at_least("change if scattered", change(&scattered, 0.5), 0.1)
        .at_most("change if gathered", change(&gathered, 0.5), 1e-6)
}

/// Light of a wall at 4 m on a black pole of 11 pixels at 1 m: the model against geometric single scattering.
pub(super) fn measure_leak() -> Finding {
    let (width, height, half) = (321, 9, 5);
    let pole = Plane::from_fn(width, height, |x, _| x.abs_diff(width / 2) <= half);
    let trial = Trial {
        radiance: Rgb::from_fn(width, height, |x, y| [f32::from(u8::from(!pole.pixel(x, y))); 3]),
        range: pole.map(|&is_pole| if is_pole { 1.0 } else { 4.0 }),
        water: coastal(ScatterModel::Jaffe, 1.0),
    };
    let scattered = trial.render(PLENTY).forward_scatter;
    let light = f64::from(scattered.pixel(width / 2, height / 2)[1]);
    let (g, c, far) = (0.042f64, 0.12f64, 4.0f64);
    let angle = half as f64 + 0.5;
    // The share of a Cauchy kernel of the wall outside the pole.
    let tail = 1.0 - FRAC_2_PI * (angle / far).atan();
    let model = ((-g * far).exp() - (-c * far).exp()) * tail;
    let ratios = [2.0, 4.0, 10.0].map(|ratio| overstate(angle, far, 1.0 / ratio));
    Finding::default()
        .at_least("times too bright, wall 4 times as far", ratios[1], 3.0)
        .at_least("the same, 2 times as far", ratios[0], 1.5)
        .at_least("the same, 10 times as far", ratios[2], 7.0)
        .at_most("off the closed form", (light / model - 1.0).abs(), 0.05)
        .at_least("light on the pole", light, 0.01)
}

/// Factor by which the model overestimates the light of the wall on the pole's middle: rays from the eye that deviate once by a
/// small angle and meet the wall next to the pole, over those of them that the pole does not block. `pole` is its share of the
/// distance to the wall.
fn overstate(angle: f64, scale: f64, pole: f64) -> f64 {
    const RAYS: u64 = 200_000;
    let stream = Stream::stage(1, "chain stability/rays");
    let (mut without, mut with) = (0u32, 0u32);
    for ray in 0..RAYS {
        let turned_at = stream.unit(ray, 0);
        let turn = scale * (PI * (stream.unit(ray, 1) - 0.5)).tan();
        let [wall, passing] = [1.0, pole].map(|at: f64| (turn * (at - turned_at)).abs());
        without += u32::from(wall > angle);
        with += u32::from(wall > angle && turned_at < pole && passing > pole * angle);
    }
    f64::from(without) / f64::from(with.max(1))
}

/// Light from all directions can converge on one pixel.
pub(super) fn measure_cone() -> Finding {
    let side = 129;
    let gamma = Plane::from_fn(side, side, |x, y| {
        let middle = (side / 2) as f32;
        let radius = (x as f32 - middle).hypot(y as f32 - middle);
        (0.7 * radius).clamp(1.0, 20.0)
    });
    let light = Plane::filled(side, side, 1.0f32);
    let nodes = Nodes::chebyshev(1.0, 20.0, 16);
    let spread = scatter(&light, &gamma, &nodes, &mut KernelCache::new());
    let most = largest(spread.data().iter().map(|&v| f64::from(v)));
    let limit = 1.0 + 0.385 * 20f64.ln();
    Finding::default()
        .at_least("light in the brightest pixel", most, 1.5)
        .at_most("the same, against 1 + 0.385 ln(20)", most, limit)
}

/// Light at the border of the frame.
pub(super) fn measure_border() -> Finding {
    let size = (37, 23);
    let cache = &mut KernelCache::new();
    let uniform = Plane::filled(size.0, size.1, 0.5f32);
    let changes = [0.1, 1.0, 8.0, widest_px(size.0, size.1)].map(|gamma: f64| {
        let plane = Plane::filled(size.0, size.1, gamma as f32);
        change(&scatter(&uniform, &plane, &Nodes::exact([gamma]), cache), 0.5)
    });
    // One bright corner: the mirrored border returns exactly the light that crosses the edge.
    let light = Plane::from_fn(size.0, size.1, |x, y| f32::from(u8::from(x + y == 0)));
    let gamma = Plane::filled(size.0, size.1, 4.0f32);
    let corner = scatter(&light, &gamma, &Nodes::exact([4.0]), cache);
    let sum: f64 = corner.data().iter().map(|&v| f64::from(v)).sum();
    Finding::default()
        .at_most("change of a uniform field", largest(changes), 1e-6)
        .at_most("lost light of a corner", (sum - 1.0).abs(), 1e-6)
}
