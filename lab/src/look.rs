//! Features of underwater photographs that renderings often lack, as statistics of a picture: uneven water, daylight, clipped
//! highlights, coarse variation, grain.

use std::f64::consts::{PI, TAU};

use imaging::{Plane, Rgb8};

/// Side of the windows for spectra, px.
const WINDOW_PX: usize = 256;
/// Frequency range for fitting the slope, cycles per window.
const FREQUENCIES: std::ops::Range<usize> = 4..64;
/// Side of the blocks for estimating grain, px, and the share of blocks that counts as flat.
const BLOCK_PX: usize = 16;
const FLAT: f64 = 0.2;
/// Minimum share of open water in a picture.
const LEAST_WATER: f64 = 0.02;

/// Statistics of one picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// Standard deviation of L* within open water; `None` if there is too little of it.
    pub(crate) spread: Option<f64>,
    /// Mean L* of the uppermost fifth minus that of the lowest.
    pub(crate) fall: f64,
    /// Share of pixels with a channel at 254 or above, percent.
    pub(crate) clipped: f64,
    /// Entropy of the gray codes, bit.
    pub(crate) entropy: f64,
    /// Slope of the power spectrum over frequency, both as logarithms.
    pub(crate) slope: f64,
    /// Noise of flat blocks, codes (Immerkær 1996).
    pub(crate) grain: f64,
}

impl Look {
    /// Statistics of a picture; code 0 of `semantics` is open water.
    pub(crate) fn of(picture: &Rgb8, semantics: &Plane<u8>) -> Self {
        let (width, height) = (picture.width(), picture.height());
        let gray = Plane::from_fn(width, height, |x, y| {
            let [r, g, b] = picture.pixel(x, y).map(f64::from);
            0.299 * r + 0.587 * g + 0.114 * b
        });
        let lightness = Plane::from_fn(width, height, |x, y| lightness(picture.pixel(x, y)));
        let water: Vec<f64> = (lightness.data().iter().zip(semantics.data()))
            .filter(|(_, code)| **code == 0)
            .map(|(l, _)| *l)
            .collect();
        let enough = water.len() as f64 >= LEAST_WATER * (width * height) as f64;
        let part = width * (height / 5);
        let clipped = (0..width * height)
            .filter(|i| {
                picture
                    .pixel(i % width, i / width)
                    .iter()
                    .any(|&code| code >= 254)
            })
            .count();
        Self {
            spread: enough.then(|| deviation(&water)),
            fall: mean(&lightness.data()[..part]) - mean(&lightness.data()[width * height - part..]),
            clipped: 100.0 * clipped as f64 / (width * height) as f64,
            entropy: entropy(&gray),
            slope: slope(&gray),
            grain: grain(&gray),
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn deviation(values: &[f64]) -> f64 {
    let middle = mean(values);
    (values.iter().map(|v| (v - middle).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// L* of sRGB codes.
fn lightness(codes: [u8; 3]) -> f64 {
    let [r, g, b] = codes.map(|code| imaging::transfer::decode(f64::from(code) / 255.0));
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    if y > 216.0 / 24_389.0 {
        116.0 * y.cbrt() - 16.0
    } else {
        24_389.0 / 27.0 * y
    }
}

fn entropy(gray: &Plane<f64>) -> f64 {
    let mut counts = [0.0f64; 256];
    for v in gray.data() {
        counts[v.round().clamp(0.0, 255.0) as usize] += 1.0;
    }
    let all = gray.data().len() as f64;
    let terms = counts.iter().filter(|&&count| count > 0.0);
    terms.map(|count| -count / all * (count / all).log2()).sum()
}

/// Noise of the flattest blocks, from the mean of an operator that cancels linear gradients.
fn grain(gray: &Plane<f64>) -> f64 {
    let (width, height) = gray.size();
    let mut blocks = Vec::new();
    for top in (1..height.saturating_sub(BLOCK_PX)).step_by(BLOCK_PX) {
        for left in (1..width.saturating_sub(BLOCK_PX)).step_by(BLOCK_PX) {
            let mut sum = 0.0;
            for y in top..top + BLOCK_PX {
                for x in left..left + BLOCK_PX {
                    let at = |dx: usize, dy: usize| gray.pixel(x + dx - 1, y + dy - 1);
                    let corners = at(0, 0) + at(2, 0) + at(0, 2) + at(2, 2);
                    let sides = at(1, 0) + at(0, 1) + at(2, 1) + at(1, 2);
                    sum += (corners - 2.0 * sides + 4.0 * at(1, 1)).abs();
                }
            }
            blocks.push((PI / 2.0).sqrt() / 6.0 * sum / (BLOCK_PX * BLOCK_PX) as f64);
        }
    }
    blocks.sort_by(f64::total_cmp);
    blocks
        .get((FLAT * blocks.len() as f64) as usize)
        .copied()
        .unwrap_or_default()
}

/// The slope of the mean spectrum of the windows of a picture.
fn slope(gray: &Plane<f64>) -> f64 {
    let (width, height) = gray.size();
    if width < WINDOW_PX || height < WINDOW_PX {
        return f64::NAN;
    }
    let mut power = vec![0.0; WINDOW_PX];
    let windows = width / WINDOW_PX;
    for window in 0..windows {
        add_spectrum(gray, (window * WINDOW_PX, (height - WINDOW_PX) / 2), &mut power);
    }
    let points: Vec<(f64, f64)> = FREQUENCIES
        .filter(|&f| power[f] > 0.0)
        .map(|f| ((f as f64).ln(), power[f].ln()))
        .collect();
    // Each octave has the same weight.
    let weight = |x: f64| (-x).exp();
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(x, y)| weight(x) * of(x, y)).sum::<f64>();
    let (one, x, y) = (sum(&|_, _| 1.0), sum(&|x, _| x), sum(&|_, y| y));
    let (xx, xy) = (sum(&|x, _| x * x), sum(&|x, y| x * y));
    (one * xy - x * y) / (one * xx - x * x)
}

/// Adds the power of a window to bins of its rounded radial frequency, averaged over directions.
fn add_spectrum(gray: &Plane<f64>, (left, top): (usize, usize), power: &mut [f64]) {
    const N: usize = WINDOW_PX;
    const HALF: usize = 64;
    let hann = |i: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / N as f64).cos();
    let rows = top..top + N;
    let middle = mean(
        &rows
            .flat_map(|y| gray.row(y)[left..left + N].to_vec())
            .collect::<Vec<_>>(),
    );
    let turn: Vec<(f64, f64)> = (0..N).map(|k| (TAU * k as f64 / N as f64).sin_cos()).collect();
    // Transforms rows first, for frequencies 0 to HALF.
    let mut first = vec![(0.0, 0.0); N * HALF];
    for y in 0..N {
        let row = &gray.row(top + y)[left..left + N];
        for f in 0..HALF {
            let mut sum = (0.0, 0.0);
            for (x, v) in row.iter().enumerate() {
                let (sin, cos) = turn[(f * x) % N];
                let v = (v - middle) * hann(x) * hann(y);
                sum = (sum.0 + v * cos, sum.1 - v * sin);
            }
            first[y * HALF + f] = sum;
        }
    }
    let (mut sums, mut counts) = (vec![0.0; power.len()], vec![0.0; power.len()]);
    for across in 0..HALF {
        for down in 0..2 * HALF {
            let down = down as i64 - HALF as i64;
            let mut sum = (0.0, 0.0);
            for y in 0..N {
                let (sin, cos) = turn[(down * y as i64).rem_euclid(N as i64) as usize];
                let (re, im) = first[y * HALF + across];
                sum = (sum.0 + re * cos + im * sin, sum.1 + im * cos - re * sin);
            }
            let radius = (across as f64).hypot(down as f64).round() as usize;
            sums[radius] += sum.0 * sum.0 + sum.1 * sum.1;
            counts[radius] += 1.0;
        }
    }
    for (power, (sum, count)) in power.iter_mut().zip(sums.iter().zip(&counts)) {
        if *count > 0.0 {
            *power += sum / count;
        }
    }
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;

    use super::*;

    #[test]
    fn white_noise_has_no_slope_and_its_own_grain() {
        let dice = Stream::stage(3, "look");
        let (width, height) = (256, 256);
        let plane = Plane::from_fn(width, height, |x, y| {
            let at = (y * width + x) as u64;
            // A sum of twelve uniform numbers is nearly normal, with standard deviation 1.
            let sum: f64 = (0..12).map(|k| dice.unit(at, k)).sum();
            100.0 + 2.0 * (sum - 6.0)
        });
        assert!(slope(&plane).abs() < 0.15, "{}", slope(&plane));
        assert!((grain(&plane) - 2.0).abs() < 0.3, "{}", grain(&plane));
    }

    #[test]
    fn a_picture_that_darkens_downwards_falls() {
        let picture = Rgb8::from_fn(64, 50, |_, y| [(200 - 3 * y) as u8; 3]);
        let look = Look::of(&picture, &Plane::filled(64, 50, 0u8));
        assert!(look.fall > 30.0 && look.clipped == 0.0 && look.spread.is_some_and(|spread| spread > 10.0));
        assert!((look.entropy - 50f64.log2()).abs() < 1e-9);
    }
}
