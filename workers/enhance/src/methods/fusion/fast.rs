//! The fusion in single precision.

use imaging::{Plane, Rgb8, vectorized};
use spec::Fusion;

use super::definition::{Fused, WEIGHT_FLOOR, balance, compensation, count_levels};
use super::pyramid::{collapse, gaussian};
use super::weight::Perceived;
use crate::blocks::{FLAT, blurred_row};
use crate::elementary::{exp, ln};

/// Pixels per block, each with its partial sum.
const LANES: usize = 16;

pub(super) fn fuse(picture: &Rgb8, parameters: &Fusion) -> Fused {
    let (width, height) = (picture.width(), picture.height());
    let codes = picture.to_planes();
    let means = codes.each_ref().map(|codes| mean(codes.data()));
    let coefficients = compensation(parameters, means);
    let [red, green, blue] = codes.each_ref().map(Plane::data);
    let compensated_means = std::array::from_fn(|c| match coefficients[c] {
        0.0 => means[c],
        coefficient => vectorized!(compensated_mean([red, green, blue][c], green, coefficient as f32)),
    });
    let gains = balance(compensated_means);
    let balanced = std::array::from_fn(|c| {
        let mut plane = Plane::filled(width, height, 0.0f32);
        let step = Balance {
            coefficient: coefficients[c] as f32,
            gain: gains[c] as f32,
        };
        vectorized!(step.apply([red, green, blue][c], green, plane.data_mut()));
        plane
    });
    let (inputs, detail) = inputs(balanced, parameters.gamma as f32);
    let [first, second] = &inputs;
    let mut perceived = Perceived::new(width, height);
    let mut share = perceived.weight(first.each_ref());
    let other = perceived.weight(second.each_ref());
    drop(perceived);
    vectorized!(normalize(share.data_mut(), other.data()));
    drop(other);
    let levels = count_levels(parameters.levels, width, height);
    let shares = gaussian(share, levels);
    let mut result = picture.clone();
    let [first, second] = inputs;
    for (channel, (mut difference, second)) in first.into_iter().zip(second).enumerate() {
        vectorized!(subtract(difference.data_mut(), second.data()));
        let details = gaussian(difference, levels);
        let codes = result.data_mut();
        collapse(&shares, &details, |y, row| {
            let codes = &mut codes[3 * width * y..3 * width * (y + 1)];
            vectorized!(encode(row, second.row(y), codes, channel));
        });
    }
    Fused {
        picture: result,
        balance: gains,
        detail,
    }
}

/// The mean of a channel in 0..=1.
fn mean(codes: &[u8]) -> f64 {
    let sum: u64 = codes.iter().map(|&code| u64::from(code)).sum();
    sum as f64 / (255 * codes.len()) as f64
}

/// The mean of a compensated channel.
#[inline(always)]
fn compensated_mean(codes: &[u8], green: &[u8], coefficient: f32) -> f64 {
    let mut sums = [0.0f64; LANES];
    let (blocks, rest) = codes.as_chunks::<LANES>();
    let (greens, green_rest) = green.as_chunks::<LANES>();
    for (codes, greens) in blocks.iter().zip(greens) {
        for x in 0..LANES {
            sums[x] += f64::from(compensated(codes[x], greens[x], coefficient));
        }
    }
    for (&code, &green) in rest.iter().zip(green_rest) {
        sums[0] += f64::from(compensated(code, green, coefficient));
    }
    sums.iter().sum::<f64>() / codes.len() as f64
}

/// `c'` of step 1.
#[inline(always)]
fn compensated(code: u8, green: u8, coefficient: f32) -> f32 {
    let (value, green) = (f32::from(code) * (1.0 / 255.0), f32::from(green) * (1.0 / 255.0));
    let value = value + coefficient * (1.0 - value) * green;
    if value < 1.0 { value } else { 1.0 }
}

/// Steps 1 and 2 of a channel.
struct Balance {
    coefficient: f32,
    gain: f32,
}

impl Balance {
    #[inline(always)]
    fn apply(&self, codes: &[u8], green: &[u8], plane: &mut [f32]) {
        let (coefficient, gain) = (self.coefficient, self.gain);
        for (to, (&code, &green)) in plane.iter_mut().zip(codes.iter().zip(green)) {
            let value = gain * compensated(code, green, coefficient);
            *to = if value < 1.0 { value } else { 1.0 };
        }
    }
}

/// Both inputs, and the gain of the second for differences.
fn inputs(balanced: [Plane<f32>; 3], gamma: f32) -> ([[Plane<f32>; 3]; 2], f64) {
    let (width, height) = balanced[0].size();
    let mut details = [0; 3].map(|_| Plane::filled(width, height, 0.0f32));
    let (mut low, mut high) = ([f32::MAX; LANES], [f32::MIN; LANES]);
    let mut scratch = vec![0.0; width + 4];
    for (plane, details) in balanced.iter().zip(&mut details) {
        for y in 0..height {
            let row = details.row_mut(y);
            vectorized!({
                blurred_row(plane, y, &mut scratch, row);
                subtract_from(row, plane.row(y));
                widen(row, &mut low, &mut high);
            });
        }
    }
    let (low, high) = (
        low.into_iter().fold(f32::MAX, f32::min),
        high.into_iter().fold(f32::MIN, f32::max),
    );
    let is_flat = f64::from(high) - f64::from(low) <= FLAT;
    let scale = if is_flat { 0.0 } else { 0.5 / (high - low) };
    let mut balanced = balanced;
    for (plane, detail) in balanced.iter_mut().zip(&mut details) {
        if is_flat {
            detail.data_mut().copy_from_slice(plane.data());
        } else {
            vectorized!(sharpen(detail.data_mut(), plane.data(), low, scale));
        }
        vectorized!(darken(plane.data_mut(), gamma));
    }
    ([balanced, details], f64::from(scale))
}

/// Widens the range of each lane by a row.
#[inline(always)]
fn widen(row: &[f32], low: &mut [f32; LANES], high: &mut [f32; LANES]) {
    let (blocks, rest) = row.as_chunks::<LANES>();
    for block in blocks {
        for x in 0..LANES {
            low[x] = if block[x] < low[x] { block[x] } else { low[x] };
            high[x] = if block[x] > high[x] { block[x] } else { high[x] };
        }
    }
    for &value in rest {
        low[0] = low[0].min(value);
        high[0] = high[0].max(value);
    }
}

/// Input 2 in place of the differences.
#[inline(always)]
fn sharpen(details: &mut [f32], values: &[f32], low: f32, scale: f32) {
    for (detail, value) in details.iter_mut().zip(values) {
        *detail = 0.5 * value + (*detail - low) * scale;
    }
}

/// Input 1 in place of the balanced channel.
#[inline(always)]
fn darken(values: &mut [f32], gamma: f32) {
    /// Far below one code, and a normal number for the logarithm.
    const BLACK: f32 = 1e-20;
    for value in values {
        let power = exp(gamma * ln(if *value > BLACK { *value } else { BLACK }));
        *value = if *value > BLACK { power } else { 0.0 };
    }
}

/// `W_1` in place of `w_1`.
#[inline(always)]
fn normalize(weights: &mut [f32], others: &[f32]) {
    const FLOOR: f32 = WEIGHT_FLOOR as f32;
    for (weight, other) in weights.iter_mut().zip(others) {
        *weight = (*weight + FLOOR) / (*weight + other + 2.0 * FLOOR);
    }
}

#[inline(always)]
fn subtract(values: &mut [f32], others: &[f32]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value -= other;
    }
}

#[inline(always)]
fn subtract_from(values: &mut [f32], others: &[f32]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = other - *value;
    }
}

/// Codes of a channel, `input 2 + row`.
#[inline(always)]
fn encode(row: &[f32], second: &[f32], codes: &mut [u8], channel: usize) {
    for (pixel, (value, second)) in codes.chunks_exact_mut(3).zip(row.iter().zip(second)) {
        let code = 255.0 * (value + second) + 0.5;
        let code = if code > 0.0 { code } else { 0.0 };
        let code = if code < 255.0 { code } else { 255.0 };
        pixel[channel] = code as i32 as u8;
    }
}
