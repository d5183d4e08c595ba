//! Contrast kept by a network, for near and for far parts of a scene.

use std::ops::Range;

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb, transfer};
use rayon::prelude::*;
use style::net::layer::Weights;
use style::net::{Network, Scratch};

/// Near band, m.
const NEAR_M: Range<f32> = 0.0..2.0;
/// Far band, m: beyond it scenes are invisible in most waters.
const FAR_M: Range<f32> = 4.0..12.0;
/// Tested scenes.
const SEEDS: Range<u64> = 100..124;
const WIDTH: usize = 240;
const HEIGHT: usize = 180;
/// Side of the contrast windows.
const WINDOW: usize = 7;
/// Windows with a smaller standard deviation of brightness have no contrast to keep.
const LEAST: f64 = 0.01;

/// Share of the contrast kept: the sum over windows of the standard deviation of the brightness (of sRGB-encoded
/// values) after, over that before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContrastKept {
    /// Nearer than 2 m.
    pub near: f64,
    /// 4 to 12 m away.
    pub far: f64,
}

/// Measures a network at alpha 1 over new scenes in air. `ranges` maps each scene's range in meters to the network's.
#[must_use]
pub fn contrast_kept(weights: &Weights, ranges: impl Fn(&Plane<f32>) -> Plane<f32> + Sync) -> ContrastKept {
    let network = Network::new(weights);
    let found = SEEDS.into_par_iter().map(|seed| {
        let lens = Intrinsics::centered(0.6 * WIDTH as f64, WIDTH, HEIGHT);
        let scene =
            scenes::procedural("structure", seed, WIDTH, HEIGHT, lens).expect("a family that is there");
        let range = scene.range.expect("a procedural scene has a range");
        let before = transfer::encode_unit(&scene.radiance);
        let given = optics::attenuation::faded(&ranges(&range), style::RANGE_SCALE_M);
        let after = network.apply(&before, Some(&given), &mut Scratch::default());
        [NEAR_M, FAR_M].map(|band| sums(&before, &after, &range, &band))
    });
    let found: Vec<[[f64; 2]; 2]> = found.collect();
    let [near, far] = [0, 1].map(|band: usize| {
        let [before, after] =
            [0, 1].map(|which: usize| found.iter().map(|scene| scene[band][which]).sum::<f64>());
        after / before
    });
    ContrastKept { near, far }
}

/// Sums of the contrast before and after, over the windows within a band of range.
fn sums(before: &Rgb<f32>, after: &Rgb<f32>, range: &Plane<f32>, band: &Range<f32>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for top in (0..HEIGHT - WINDOW).step_by(WINDOW) {
        for left in (0..WIDTH - WINDOW).step_by(WINDOW) {
            let window: [(usize, usize); WINDOW * WINDOW] =
                std::array::from_fn(|i| (left + i % WINDOW, top + i / WINDOW));
            let is_inside = window
                .iter()
                .all(|&(x, y)| band.contains(&range.pixel(x, y)) && range.pixel(x, y) > 0.0);
            if !is_inside {
                continue;
            }
            let contrast = deviation(before, &window);
            if contrast >= LEAST {
                sums[0] += contrast;
                sums[1] += deviation(after, &window);
            }
        }
    }
    sums
}

fn brightness([r, g, b]: [f32; 3]) -> f64 {
    0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
}

/// Standard deviation of the brightness in a window.
fn deviation(picture: &Rgb<f32>, window: &[(usize, usize)]) -> f64 {
    let samples = window.iter().map(|&(x, y)| brightness(picture.pixel(x, y)));
    let count = window.len() as f64;
    let mean = samples.clone().sum::<f64>() / count;
    (samples.map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}
