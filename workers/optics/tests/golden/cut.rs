//! Where the stored arrays of two kernels come from.

use std::f64::consts::PI;

use imaging::dct::Dct2;
use imaging::{Plane, Rgb};
use optics::kernel::{Transfer, pixel};

use crate::case::Case;

/// Kernels that the arrays were made with.
const NODES: usize = 24;
/// Narrower ones end so many pixels away; what lies beyond is in their middle.
const NARROW: f64 = 0.3;
const REACH: i64 = 60;
/// Added to a scale before its logarithm is taken.
const SHIFT: f64 = 0.3;

/// Forward scatter by two kernels as the prototype computed it, whose narrow kernels are cut off against the definition.
pub(crate) fn forward_of_cut_kernels(case: &Case, radiance: &Rgb<f64>, range: &Plane<f64>) -> Rgb<f64> {
    let focal = case.number("focal_px").expect("a focal length");
    let [a, b] = ["absorption", "scattering"].map(|name| case.triple(name).expect("three values"));
    let planes = [0, 1, 2].map(|channel| {
        let water = (a[channel], b[channel], focal);
        of_channel(&radiance.planes()[channel], range, water)
    });
    Rgb::new(planes).expect("planes of one frame")
}

fn of_channel(radiance: &Plane<f64>, range: &Plane<f64>, (a, b, focal): (f64, f64, f64)) -> Plane<f64> {
    let (width, height) = range.size();
    let is_seen = |z: f64| z.is_finite() && z > 0.0;
    // A hole counts as 1 m where scales are spanned.
    let meters: Vec<f64> = range
        .data()
        .iter()
        .map(|&z| if is_seen(z) { z } else { 1.0 })
        .collect();
    let scales = |z: f64| [focal * (0.0015 + 0.0007 * b * z), focal * (0.035 + 0.010 * b * z)];
    let place = |gamma: f64| (gamma + SHIFT).ln();
    let all = meters.iter().flat_map(|&z| scales(z)).map(place);
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| {
        (l.min(s), h.max(s))
    });
    let angle = |k: usize| PI * (k as f64 + 0.5) / NODES as f64;
    let node = |k: usize| (low + high) / 2.0 + (high - low) / 2.0 * angle(k).cos();
    // Barycentric weights of Chebyshev nodes.
    let weight = |k: usize| {
        if k.is_multiple_of(2) {
            angle(k).sin()
        } else {
            -angle(k).sin()
        }
    };
    let share = |s: f64, k: usize| {
        let of = |k: usize| weight(k) / (s - node(k));
        of(k) / (0..NODES).map(of).sum::<f64>()
    };
    let mut transform = Dct2::new(width, height);
    let mut sum = vec![0.0; meters.len()];
    for k in 0..NODES {
        let mut light: Vec<f64> = (0..meters.len())
            .map(|at| {
                let z = meters[at];
                let [narrow, wide] = scales(z).map(|gamma| share(place(gamma), k));
                let spread = (-(a + 0.05 * b) * z).exp() - (-(a + b) * z).exp();
                let m = (0.63 + 0.065 * b * z).min(1.0);
                let shown = f64::from(u8::from(is_seen(range.data()[at])));
                shown * radiance.data()[at] * spread * ((1.0 - m) * narrow + m * wide)
            })
            .collect();
        transform.forward(&mut light);
        let kernel = transfer((node(k).exp() - SHIFT).max(0.0), (width, height));
        for ((sum, light), kernel) in sum.iter_mut().zip(&light).zip(&kernel) {
            *sum += light * kernel;
        }
    }
    transform.inverse(&mut sum);
    Plane::new(width, height, sum).expect("the size of the frame")
}

fn transfer(gamma: f64, (width, height): (usize, usize)) -> Vec<f64> {
    if gamma >= NARROW {
        return Transfer::new(gamma).grid(width, height);
    }
    let side = -REACH..=REACH;
    let mut kernel: Vec<Vec<f64>> = side
        .clone()
        .map(|j| side.clone().map(|i| pixel(i, j, gamma)).collect())
        .collect();
    kernel[REACH as usize][REACH as usize] += 1.0 - kernel.iter().flatten().sum::<f64>();
    let waves = |count: usize| -> Vec<Vec<f64>> {
        let wave = |p: usize| {
            side.clone()
                .map(|i| (PI * p as f64 * i as f64 / count as f64).cos())
                .collect()
        };
        (0..count).map(wave).collect()
    };
    let (across, down) = (waves(width), waves(height));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Over columns first, then over rows.
    let rows: Vec<Vec<f64>> = (across.iter())
        .map(|wave| kernel.iter().map(|row| dot(row, wave)).collect())
        .collect();
    let grid = down
        .iter()
        .flat_map(|wave| rows.iter().map(|column| dot(column, wave)));
    grid.collect()
}
