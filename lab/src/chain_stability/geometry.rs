//! Range profiles that the model or its interpolation handles badly.

use std::f64::consts::FRAC_2_PI;

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::forward_scatter::{KernelCache, Nodes, gather, scatter, widest_px};
use spec::{Fidelity, ScatterModel};

use super::trial::{PLENTY, TOLERANCE, Trial, noise, water};
use super::{Figure, Finding, pictures};

const SHOWN: (usize, usize) = (240, 160);

/// Two walls side by side.
fn step((width, height): (usize, usize), near: f32, far: f32) -> Plane<f32> {
    Plane::from_fn(width, height, |x, _| if x < width / 2 { near } else { far })
}

/// A step in range, with very different kernels on both sides.
#[must_use]
pub fn a_step_in_range() -> Finding {
    let size = (72, 48);
    let trial = |model, size: (usize, usize)| Trial {
        radiance: noise(size, 1.0),
        // A few ranges on each side; otherwise one kernel per range would be exact.
        range: Plane::from_fn(size.0, size.1, |x, y| {
            step(size, 2.0, 15.0).pixel(x, y) * (1.0 + 0.01 * (y % 24) as f32)
        }),
        water: water(model, 0.7),
    };
    let asked = Fidelity::Tolerance(TOLERANCE);
    let uniform = Plane::filled(size.0, size.1, 0.5f32);
    let gamma = step(size, 1.0, 7.5);
    let nodes = Nodes::exact([1.0, 7.5]);
    let cache = &mut KernelCache::new();
    let scattered = scatter(&uniform, &gamma, &nodes, cache);
    let gathered = gather(&uniform, &gamma, &nodes, cache);
    let largest = |plane: &Plane<f32>, from: f32| {
        let off = plane.data().iter().map(|v| f64::from((v - from).abs()));
        off.fold(0.0, f64::max)
    };
    let jaffe = |fidelity| trial(ScatterModel::Jaffe, size).error(fidelity);
    let large = trial(ScatterModel::Jaffe, SHOWN);
    let exact = large.fast(PLENTY).scattered;
    let off = |fidelity, gain| pictures::difference(&large.fast(fidelity).scattered, &exact, gain);
    Finding {
        test: "a_step_in_range",
        tried: "Noise on a wall at 2 m beside one at 15 m, kernels of 1.4 and 10 pixels; and a uniform 0.5 without any \
                attenuation.",
        figures: vec![
            Figure::at_most("error at tolerance 3e-4, jaffe", jaffe(asked), TOLERANCE),
            Figure::at_most(
                "error at tolerance 3e-4, simplified",
                trial(ScatterModel::Simplified, size).error(asked),
                TOLERANCE,
            ),
            Figure::at_most("error with 4 kernels, jaffe", jaffe(Fidelity::Terms(4)), 3.5e-3),
            Figure::at_most("error with 8 kernels, jaffe", jaffe(Fidelity::Terms(8)), 9e-5),
            Figure::at_least(
                "change of a uniform field that is scattered",
                largest(&scattered, 0.5),
                0.1,
            ),
            Figure::at_most(
                "change of a uniform field that is gathered",
                largest(&gathered, 0.5),
                1e-6,
            ),
        ],
        meaning: "Edges in range cost nothing but the usual number of kernels. Scattering carries light over the edge, so the \
                  side from which more is thrown gets darker; that is what the Jaffe form means, and why the simplified form, \
                  which spreads all of the image, gathers instead.",
        picture: Some((
            "step",
            "The step under water; its error with 2 kernels, with 4 and as planned for 3e-4, each 200 times as bright.",
            pictures::row(&[
                exact.clone(),
                off(Fidelity::Terms(2), 200.0),
                off(Fidelity::Terms(4), 200.0),
                off(asked, 200.0),
            ]),
        )),
    }
}

/// Light of a far wall on a near pole: the model against geometric single scattering.
#[must_use]
pub fn far_light_over_a_near_object() -> Finding {
    let half = 5;
    let (width, height) = (321, 9);
    let pole = |x: usize| x.abs_diff(width / 2) <= half;
    let (near, far) = (1.0f32, 4.0f32);
    let frame = |(width, height): (usize, usize), pole: &dyn Fn(usize) -> bool| Trial {
        radiance: Rgb::from_fn(width, height, |x, _| [if pole(x) { 0.0 } else { 1.0 }; 3]),
        range: Plane::from_fn(width, height, |x, _| if pole(x) { near } else { far }),
        water: water(ScatterModel::Jaffe, 1.0),
    };
    let trial = frame((width, height), &pole);
    let light = trial.fast(PLENTY).forward_scatter.pixel(width / 2, height / 2)[1];
    let (g, c) = (0.042f64, 0.12f64);
    let share = (-g * f64::from(far)).exp() - (-c * f64::from(far)).exp();
    let (gamma, angle) = (f64::from(far), half as f64 + 0.5);
    let model = share * tail(angle, gamma);
    let ratios = [2.0, 4.0, 10.0].map(|ratio| overstated(angle, gamma, 1.0 / ratio));
    let shown = frame(SHOWN, &|x| x.abs_diff(120) <= 12);
    let lit = Trial {
        radiance: Rgb::from_fn(SHOWN.0, SHOWN.1, |x, y| {
            let stripes = if (x / 16 + y / 16) % 2 == 0 { 0.9 } else { 0.3 };
            [if x.abs_diff(120) <= 12 { 0.02 } else { stripes }; 3]
        }),
        range: shown.range.clone(),
        water: water(ScatterModel::Jaffe, 3.0),
    };
    let layers = lit.fast(PLENTY);
    Finding {
        test: "far_light_over_a_near_object",
        tried: "A black pole of 11 pixels at 1 m before a white wall at 4 m, kernel of the wall 4 pixels. The model spreads the \
                wall's light over the pole as if it stood at the wall's distance. Light that is scattered once, by a small angle, \
                reaches the eye in the direction of the pole only if it is scattered in front of it and passes it by: 200 000 traced \
                rays say how often.",
        figures: vec![
            Figure::at_least(
                "times too much light on the pole, wall 4 times as far",
                ratios[1],
                3.0,
            ),
            Figure::at_least("the same, 2 times as far", ratios[0], 1.5),
            Figure::at_least("the same, 10 times as far", ratios[2], 7.0),
            Figure::at_most(
                "light on the middle of the pole against the closed form of the model, relative",
                (f64::from(light) / model - 1.0).abs(),
                0.05,
            ),
            Figure::at_least("light on the middle of the pole, linear", f64::from(light), 0.01),
        ],
        meaning: "The halo of a far, bright background over a near, dark object is too strong by about the ratio of their \
                  ranges: no model of one kernel per pixel knows what stands in the way. Do not learn from the insides of dark \
                  objects close to the camera; where it matters, ask for forward scatter of the model `none`.",
        picture: Some((
            "leak",
            "A dark pole at 1 m before a wall at 4 m: in air, under water, and the forward scatter alone, five times as bright.",
            pictures::row(&[
                lit.radiance.clone(),
                layers.scattered.clone(),
                layers.forward_scatter.map(|v| 5.0 * v),
            ]),
        )),
    }
}

/// Share of the light of a Cauchy kernel outside an angle on both sides.
fn tail(angle: f64, gamma: f64) -> f64 {
    1.0 - FRAC_2_PI * (angle / gamma).atan()
}

/// Factor by which the model overestimates the light of the wall on the pole's middle: rays from the eye that deviate once by a
/// small angle and meet the wall next to the pole, over those of them that the pole does not block. `pole` is its share of the
/// distance to the wall.
fn overstated(angle: f64, scale: f64, pole: f64) -> f64 {
    const RAYS: u64 = 200_000;
    let stream = Stream::stage(1, "chain stability/rays");
    let (mut without, mut with) = (0u32, 0u32);
    for ray in 0..RAYS {
        let turned_at = stream.unit(ray, 0);
        let turn = scale * (std::f64::consts::PI * (stream.unit(ray, 1) - 0.5)).tan();
        let aside = |at: f64| turn * (at - turned_at);
        let meets_wall = aside(1.0).abs() > angle;
        let passes = turned_at < pole && aside(pole).abs() > pole * angle;
        without += u32::from(meets_wall);
        with += u32::from(meets_wall && passes);
    }
    f64::from(without) / f64::from(with.max(1))
}

/// Light from all directions can converge on one pixel.
#[must_use]
pub fn a_cone_focuses_light() -> Finding {
    let side = 129;
    let gamma = Plane::from_fn(side, side, |x, y| {
        let middle = (side / 2) as f32;
        let radius = (x as f32 - middle).hypot(y as f32 - middle);
        (0.7 * radius).clamp(1.0, 20.0)
    });
    let light = Plane::filled(side, side, 1.0f32);
    let nodes = Nodes::chebyshev(1.0, 20.0, 16);
    let spread = scatter(&light, &gamma, &nodes, &mut KernelCache::new());
    let most = f64::from(spread.data().iter().copied().fold(0.0, f32::max));
    Finding {
        test: "a_cone_focuses_light",
        tried: "A uniform light of 1 in a range shaped as a cone, kernels from 1 pixel in the middle to 20 outside.",
        figures: vec![
            Figure::at_least("light in the brightest pixel", most, 1.5),
            Figure::at_most(
                "the same, against 1 + 0.385 ln(20)",
                most,
                1.0 + 0.385 * 20f64.ln(),
            ),
        ],
        meaning: "Spread light is not bounded by the brightest source. The plan reckons with it: it skips forward scatter only \
                  where what can meet in a pixel stays below the tolerance.",
        picture: None,
    }
}

/// Light at the border of the frame.
#[must_use]
pub fn the_border() -> Finding {
    let size = (37, 23);
    let cache = &mut KernelCache::new();
    let even = |gamma: f64| {
        let plane = Plane::filled(size.0, size.1, gamma as f32);
        let light = Plane::filled(size.0, size.1, 0.5f32);
        scatter(&light, &plane, &Nodes::exact([gamma]), cache)
    };
    let gammas = [0.1, 1.0, 8.0, widest_px(size.0, size.1)];
    let planes = gammas.map(even);
    let off = planes
        .iter()
        .flat_map(|plane| plane.data().iter().map(|v| f64::from((v - 0.5).abs())));
    let corner = {
        // One bright corner: the mirrored border returns exactly the light that crosses the edge.
        let light = Plane::from_fn(size.0, size.1, |x, y| f32::from(u8::from(x + y == 0)));
        let gamma = Plane::filled(size.0, size.1, 4.0f32);
        scatter(&light, &gamma, &Nodes::exact([4.0]), cache)
    };
    let sum: f64 = corner.data().iter().map(|&v| f64::from(v)).sum();
    Finding {
        test: "the_border",
        tried: "A uniform field under kernels from 0.1 pixels to the widest; a single light in the corner.",
        figures: vec![
            Figure::at_most(
                "change of the uniform field anywhere",
                off.fold(0.0, f64::max),
                1e-6,
            ),
            Figure::at_most("light of the corner that is lost", (sum - 1.0).abs(), 1e-6),
        ],
        meaning: "The frame is a box of mirrors: no corner is darkened, nothing wraps around, no light is lost. What lies \
                  outside the frame is taken to look like what lies inside.",
        picture: None,
    }
}
