//! Range profiles that the model or its interpolation handles badly.

use std::f64::consts::{FRAC_2_PI, PI};

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::forward_scatter::{KernelCache, Nodes, gather, scatter, widest_px};
use spec::{Fidelity, ScatterModel};

use super::finding::Finding;
use super::trial::{DEFAULT, PLENTY, TOLERANCE, Trial, coastal, noise};
use crate::statistics::largest;

const SHOWN: (usize, usize) = (240, 160);

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

/// A step in range, with very different kernels on both sides. The picture: the step under water; its error with 2 kernels, with 4
/// and as planned, each 200 times as bright.
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
    let shown = step_trial(ScatterModel::Jaffe, SHOWN);
    let exact = shown.render(PLENTY).scattered;
    let errors = [Fidelity::Terms(2), Fidelity::Terms(4), DEFAULT].map(|fidelity| {
        let fast = shown.render(fidelity).scattered;
        Rgb::from_fn(SHOWN.0, SHOWN.1, |x, y| {
            let (a, b) = (fast.pixel(x, y), exact.pixel(x, y));
            [0, 1, 2].map(|c| 200.0 * (a[c] - b[c]).abs())
        })
    });
    let [two, four, planned] = errors;
    Finding::default()
        .at_most("error at tolerance 3e-4, jaffe", jaffe.error(DEFAULT), TOLERANCE)
        .at_most(
            "error at tolerance 3e-4, simplified",
            simplified.error(DEFAULT),
            TOLERANCE,
        )
        .at_most(
            "error with 4 kernels, jaffe",
            jaffe.error(Fidelity::Terms(4)),
            3.5e-3,
        )
        .at_most(
            "error with 8 kernels, jaffe",
            jaffe.error(Fidelity::Terms(8)),
            9e-5,
        )
        .at_least(
            "change of a uniform field, scattered",
            change(&scattered, 0.5),
            0.1,
        )
        .at_most(
            "change of a uniform field, gathered",
            change(&gathered, 0.5),
            1e-6,
        )
        .with_row(&[exact, two, four, planned])
}

/// A dark pole in front of a bright wall.
fn pole_trial((width, height): (usize, usize), half: usize, spread: f64) -> Trial {
    let is_pole = |x: usize| x.abs_diff(width / 2) <= half;
    Trial {
        radiance: Rgb::from_fn(width, height, |x, _| [if is_pole(x) { 0.0 } else { 1.0 }; 3]),
        range: Plane::from_fn(width, height, |x, _| if is_pole(x) { 1.0 } else { 4.0 }),
        water: coastal(ScatterModel::Jaffe, spread),
    }
}

/// Light of a far wall on a near pole: the model against geometric single scattering. The picture: in air, under water, and the
/// forward scatter alone, five times as bright.
pub(super) fn measure_leak() -> Finding {
    let half = 5;
    let (width, height) = (321, 9);
    let scattered = pole_trial((width, height), half, 1.0)
        .render(PLENTY)
        .forward_scatter;
    let light = f64::from(scattered.pixel(width / 2, height / 2)[1]);
    let (g, c, far) = (0.042f64, 0.12f64, 4.0f64);
    let angle = half as f64 + 0.5;
    // The share of a Cauchy kernel of the wall outside the pole.
    let tail = 1.0 - FRAC_2_PI * (angle / far).atan();
    let model = ((-g * far).exp() - (-c * far).exp()) * tail;
    let ratios = [2.0, 4.0, 10.0].map(|ratio| overstate(angle, far, 1.0 / ratio));
    let mut shown = pole_trial(SHOWN, 12, 3.0);
    shown.radiance = Rgb::from_fn(SHOWN.0, SHOWN.1, |x, y| {
        let stripes = if (x / 16 + y / 16) % 2 == 0 { 0.9 } else { 0.3 };
        [if x.abs_diff(120) <= 12 { 0.02 } else { stripes }; 3]
    });
    let layers = shown.render(PLENTY);
    Finding::default()
        .at_least(
            "times too much light on the pole, wall 4 times as far",
            ratios[1],
            3.0,
        )
        .at_least("the same, 2 times as far", ratios[0], 1.5)
        .at_least("the same, 10 times as far", ratios[2], 7.0)
        .at_most(
            "light on the pole against the closed form of the model, relative",
            (light / model - 1.0).abs(),
            0.05,
        )
        .at_least("light on the middle of the pole, linear", light, 0.01)
        .with_row(&[
            shown.radiance.clone(),
            layers.scattered.clone(),
            layers.forward_scatter.map(|v| 5.0 * v),
        ])
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
    Finding::default()
        .at_least("light in the brightest pixel", most, 1.5)
        .at_most(
            "the same, against 1 + 0.385 ln(20)",
            most,
            1.0 + 0.385 * 20f64.ln(),
        )
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
        .at_most("change of the uniform field anywhere", largest(changes), 1e-6)
        .at_most("light of the corner that is lost", (sum - 1.0).abs(), 1e-6)
}
