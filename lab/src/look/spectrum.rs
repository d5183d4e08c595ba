//! The slope of the power spectrum of a picture.

use std::f64::consts::TAU;

use imaging::Plane;

use crate::statistics::mean;

/// Side of the windows, px.
const WINDOW_PX: usize = 256;
const HALF: usize = 64;
/// Frequencies of the fit, cycles per window.
const FREQUENCIES: std::ops::Range<usize> = 4..HALF;

/// The slope of the mean spectrum of the windows of a picture over frequency, both as logarithms; `None` for small pictures.
pub(super) fn slope(gray: &Plane<f64>) -> Option<f64> {
    let (width, height) = gray.size();
    if width < WINDOW_PX || height < WINDOW_PX {
        return None;
    }
    let mut power = vec![0.0; WINDOW_PX];
    for window in 0..width / WINDOW_PX {
        add_spectrum(gray, (window * WINDOW_PX, (height - WINDOW_PX) / 2), &mut power);
    }
    let mut sums = [0.0; 5];
    for frequency in FREQUENCIES.filter(|&f| power[f] > 0.0) {
        let (x, y) = ((frequency as f64).ln(), power[frequency].ln());
        // Each octave has the same weight.
        let weight = 1.0 / frequency as f64;
        for (sum, term) in sums.iter_mut().zip([1.0, x, y, x * x, x * y]) {
            *sum += weight * term;
        }
    }
    let [one, x, y, xx, xy] = sums;
    Some((one * xy - x * y) / (one * xx - x * x))
}

/// Adds the power of a window to bins of its rounded radial frequency, averaged over directions.
fn add_spectrum(gray: &Plane<f64>, (left, top): (usize, usize), power: &mut [f64]) {
    const N: usize = WINDOW_PX;
    let hann: Vec<f64> = (0..N)
        .map(|i| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / N as f64).cos())
        .collect();
    let rows: Vec<&[f64]> = (top..top + N).map(|y| &gray.row(y)[left..left + N]).collect();
    let middle = mean(&rows.concat());
    let turn: Vec<(f64, f64)> = (0..N).map(|k| (TAU * k as f64 / N as f64).sin_cos()).collect();
    // Transforms rows first, for frequencies 0 to HALF.
    let mut first = vec![(0.0, 0.0); N * HALF];
    for (y, row) in rows.iter().enumerate() {
        for f in 0..HALF {
            let samples = row.iter().enumerate();
            first[y * HALF + f] = samples.fold((0.0, 0.0), |(re, im), (x, v)| {
                let (sin, cos) = turn[(f * x) % N];
                let v = (v - middle) * hann[x] * hann[y];
                (re + v * cos, im - v * sin)
            });
        }
    }
    let (mut sums, mut counts) = (vec![0.0; power.len()], vec![0.0; power.len()]);
    for across in 0..HALF {
        for down in -(HALF as i64)..HALF as i64 {
            let (re, im) = (0..N).fold((0.0, 0.0), |(re, im), y| {
                let (sin, cos) = turn[(down * y as i64).rem_euclid(N as i64) as usize];
                let (a, b) = first[y * HALF + across];
                (re + a * cos + b * sin, im + b * cos - a * sin)
            });
            let radius = (across as f64).hypot(down as f64).round() as usize;
            sums[radius] += re * re + im * im;
            counts[radius] += 1.0;
        }
    }
    for (power, (sum, count)) in power.iter_mut().zip(sums.iter().zip(&counts)) {
        if *count > 0.0 {
            *power += sum / count;
        }
    }
}
