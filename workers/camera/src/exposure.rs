//! Exposure: a fixed gain, or one that brings a percentile of the luminance to a target.
//!
//! `g = clamp(target / y, 1/64, 64)`; y is the sample at `min(n-1, floor(percentile n))` of the ascending luminances
//! `0.2126 R + 0.7152 G + 0.0722 B` of the vignetted picture. y ≤ 0: 64.

mod bound;

pub use bound::{luminance_rounding, metered_slope};

use imaging::{Rgb, vectorized};
use spec::Metering;

use crate::vignette::FallOff;

/// The largest gain of metering, and the reciprocal of the smallest.
pub const MOST_GAIN: f64 = 64.0;
/// Luminance weights of R, G, B.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Shift to the bucket bits of a float: exponent and three fraction bits.
const BUCKET_SHIFT: u32 = 20;

/// The gain from metering a picture before its fall-off is applied.
#[must_use]
pub fn metered(picture: &Rgb<f32>, falloff: Option<&FallOff>, metering: &Metering) -> f64 {
    let mut luminance = luminances(picture, falloff);
    let count = luminance.len();
    if count == 0 {
        return MOST_GAIN;
    }
    let position = ((metering.percentile * count as f64) as usize).min(count - 1);
    gain(f64::from(nth(&mut luminance, position)), metering)
}

/// Reference in f64 for a vignetted picture.
#[must_use]
pub fn metered_reference(vignetted: &Rgb<f64>, metering: &Metering) -> f64 {
    let [r, g, b] = vignetted.planes().each_ref().map(|plane| plane.data());
    let all = r.iter().zip(g).zip(b);
    let mut luminance: Vec<f64> = all
        .map(|((r, g), b)| LUMINANCE[0] * r + LUMINANCE[1] * g + LUMINANCE[2] * b)
        .collect();
    luminance.sort_by(f64::total_cmp);
    let count = luminance.len();
    let position = ((metering.percentile * count as f64) as usize).min(count.saturating_sub(1));
    gain(luminance.get(position).copied().unwrap_or(0.0), metering)
}

fn gain(luminance: f64, metering: &Metering) -> f64 {
    if luminance > 0.0 {
        (metering.target / luminance).clamp(1.0 / MOST_GAIN, MOST_GAIN)
    } else {
        MOST_GAIN
    }
}

/// The gain that follows `before` with a lag: `g (g_auto/g)^(1 - e^(-1/lag))`.
#[must_use]
pub fn lagging(before: f64, metered: f64, lag_frames: f64) -> f64 {
    if lag_frames <= 0.0 {
        return metered;
    }
    let share = 1.0 - libm::exp(-1.0 / lag_frames);
    before * libm::pow(metered / before, share)
}

fn luminances(picture: &Rgb<f32>, falloff: Option<&FallOff>) -> Vec<f32> {
    let width = picture.width().max(1);
    let [r, g, b] = picture.planes().each_ref().map(|plane| plane.data());
    let mut luminance = vec![0.0f32; r.len()];
    vectorized!(weigh(&mut luminance, r, g, b));
    if let Some(falloff) = falloff {
        let mut factors = vec![0.0f32; width];
        for (y, row) in luminance.chunks_mut(width).enumerate() {
            falloff.factors(y, 1.0, &mut factors);
            row.iter_mut().zip(&factors).for_each(|(v, factor)| *v *= factor);
        }
    }
    luminance
}

#[inline(always)]
fn weigh(luminance: &mut [f32], r: &[f32], g: &[f32], b: &[f32]) {
    let [x, y, z] = LUMINANCE.map(|weight| weight as f32);
    for (sum, ((r, g), b)) in luminance.iter_mut().zip(r.iter().zip(g).zip(b)) {
        *sum = x * r + y * g + z * b;
    }
}

/// The value at a position of the ascending order. Buckets by the upper bits first exclude most values.
fn nth(values: &mut [f32], position: usize) -> f32 {
    let mut counts = vec![0usize; 1 << (32 - BUCKET_SHIFT)];
    values.iter().for_each(|&value| counts[bucket_of(value)] += 1);
    let mut before = 0;
    let bucket = counts.iter().position(|count| {
        before += count;
        before > position
    });
    let bucket = bucket.expect("the position is one of the values");
    let rank = position - (before - counts[bucket]);
    let mut among: Vec<f32> = values
        .iter()
        .copied()
        .filter(|&value| bucket_of(value) == bucket)
        .collect();
    *among.select_nth_unstable_by(rank, f32::total_cmp).1
}

fn bucket_of(value: f32) -> usize {
    let bits = value.to_bits();
    // Also ascending for negative floats.
    ((bits ^ ((bits as i32 >> 31) as u32 | 1 << 31)) >> BUCKET_SHIFT) as usize
}

#[cfg(test)]
mod tests {
    use imaging::Plane;

    use super::*;

    const HALF: Metering = Metering {
        target: 0.5,
        percentile: 0.5,
        lag_frames: 0.0,
    };

    #[test]
    fn any_position_is_that_of_the_sorted_values() {
        let mut values: Vec<f32> = (0..997u32)
            .map(|i| ((i * 7919) % 997) as f32 * 0.01 - 2.0)
            .collect();
        let mut sorted = values.clone();
        sorted.sort_by(f32::total_cmp);
        for position in [0, 1, 300, 498, 996] {
            assert_eq!(nth(&mut values, position), sorted[position]);
        }
    }

    #[test]
    fn the_percentile_is_brought_to_the_target() {
        let picture = Rgb::from_fn(10, 1, |x, _| [x as f32 / 10.0; 3]);
        assert!((metered(&picture, None, &HALF) - 1.0).abs() < 1e-6);
        let wide = picture.map(|&v| f64::from(v));
        assert!((metered_reference(&wide, &HALF) - 1.0).abs() < 1e-6);
        let black = Rgb::from_fn(2, 2, |_, _| [0.0f32; 3]);
        assert_eq!(metered(&black, None, &HALF), MOST_GAIN);
        let empty = Rgb::new([const { 0 }; 3].map(|_| Plane::new(0, 0, Vec::new()).unwrap())).unwrap();
        assert_eq!(metered(&empty, None, &HALF), MOST_GAIN);
    }

    #[test]
    fn lag_goes_part_of_the_way_and_none_goes_all() {
        assert_eq!(lagging(1.0, 4.0, 0.0), 4.0);
        let step = lagging(1.0, 4.0, 5.0);
        assert!(step > 1.0 && step < 1.5, "{step}");
        assert_eq!(lagging(4.0, 4.0, 5.0), 4.0);
    }
}
