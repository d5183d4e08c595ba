//! Steps 1 to 4: the curve of each channel.

use imaging::Rgb8;

use crate::blocks::histogram::{self, CodeCounts, Curves, histograms};
use crate::variant::Variant;

/// A value this close to an integer or to the mean counts as equal to it: rounding must not move it.
const EQUAL: f64 = 1e-9;

/// The curves with α = `scale`, above 0.
pub(super) fn curves(picture: &Rgb8, scale: f64, variant: Variant) -> Curves {
    let counts = histograms(picture);
    let gains = gains(counts.each_ref().map(histogram::mean));
    std::array::from_fn(|channel| {
        let (low, high) = histogram::ends(&counts[channel]);
        let scaled: [f64; 256] = std::array::from_fn(|code| (code as f64 * gains[channel]).min(255.0));
        let (low, high) = (scaled[low], scaled[high]);
        if high <= low {
            return scaled;
        }
        let values = scaled.map(|value| (value - low) / (high - low) * 255.0);
        match variant {
            Variant::Fast => merged(&values, &counts[channel], scale),
            Variant::Reference => merged_by_pixels(&values, picture, channel, scale),
        }
    })
}

/// Step 1: the gain of each channel. Among equal means the first channel counts as both smallest and largest.
fn gains(means: [f64; 3]) -> [f64; 3] {
    let mut sorted = means;
    sorted.sort_unstable_by(f64::total_cmp);
    let [min, med, max] = sorted;
    let first = |mean: f64| means.iter().position(|&own| own == mean).unwrap_or(0);
    let mut gains = [1.0; 3];
    if min > 0.0 {
        gains[first(min)] *= med / min;
    }
    if med > 0.0 {
        gains[first(max)] *= med / max;
    }
    gains
}

/// `f(C)`, truncated to an integer code.
fn rayleigh(share: f64, scale: f64) -> f64 {
    if share >= 1.0 {
        return 255.0;
    }
    let rest = 1.0 - (1.0 - (-1.0 / (2.0 * scale * scale)).exp()) * share;
    (255.0 * (-2.0 * scale * scale * rest.ln()).sqrt())
        .min(255.0)
        .floor()
}

fn whole(value: f64) -> usize {
    (value + EQUAL) as usize
}

/// Steps 3 and 4 on histograms.
fn merged(values: &[f64; 256], counts: &CodeCounts, scale: f64) -> [f64; 256] {
    let total = histogram::total(counts) as f64;
    let mean = values
        .iter()
        .zip(counts)
        .map(|(value, &count)| value * count as f64)
        .sum::<f64>()
        / total;
    let is_lower = |value: f64| value <= mean + EQUAL;
    let mut sets: [CodeCounts; 2] = [[0; 256]; 2];
    for (&value, count) in values.iter().zip(counts).filter(|(_, count)| **count > 0) {
        sets[usize::from(!is_lower(value))][whole(value)] += count;
    }
    let shares = sets.map(|set| {
        let total = histogram::total(&set).max(1) as f64;
        let mut before = 0;
        set.map(|count| {
            before += count;
            before as f64 / total
        })
    });
    values.map(|value| {
        let lower = is_lower(value);
        let code = rayleigh(shares[usize::from(!lower)][whole(value).min(255)], scale);
        (code + if lower { 0.0 } else { 255.0 }) / 2.0
    })
}

/// Steps 3 and 4 on the pixels.
fn merged_by_pixels(values: &[f64; 256], picture: &Rgb8, channel: usize, scale: f64) -> [f64; 256] {
    let pixels: Vec<f64> = picture
        .pixels()
        .map(|pixel| values[usize::from(pixel[channel])])
        .collect();
    let mean = pixels.iter().sum::<f64>() / pixels.len() as f64;
    let (lower, upper): (Vec<f64>, Vec<f64>) = pixels.iter().partition(|value| **value <= mean + EQUAL);
    values.map(|value| {
        let (set, other_picture) = if value <= mean + EQUAL {
            (&lower, 0.0)
        } else {
            (&upper, 255.0)
        };
        let below = set.iter().filter(|&&other| whole(other) <= whole(value)).count();
        let share = below as f64 / set.len().max(1) as f64;
        (rayleigh(share, scale) + other_picture) / 2.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_move_to_the_middle_one() {
        assert_eq!(gains([10.0, 40.0, 20.0]), [2.0, 0.5, 1.0]);
        assert_eq!(gains([7.0; 3]), [1.0; 3]);
        assert_eq!(gains([0.0, 40.0, 20.0]), [1.0, 0.5, 1.0]);
        // With light in one channel only, the middle mean is 0: gains stay 1.
        assert_eq!(gains([0.0, 40.0, 0.0]), [1.0; 3]);
        assert_eq!(gains([0.0; 3]), [1.0; 3]);
    }

    #[test]
    fn the_distribution_ends_at_white() {
        assert_eq!((rayleigh(0.0, 0.4), rayleigh(1.0, 0.4)), (0.0, 255.0));
        // 1 - (1 - exp(-3.125)) / 2 = 0.52197; 255 · sqrt(-0.32 ln 0.52197) = 116.28.
        assert_eq!(rayleigh(0.5, 0.4), 116.0);
    }

    #[test]
    fn two_values_go_to_the_middle_and_to_white() {
        let picture = Rgb8::from_fn(4, 1, |x, _| [[60, 60, 180, 180][x], 100, 100]);
        for variant in [Variant::Fast, Variant::Reference] {
            let [red, green, _] = curves(&picture, 0.4, variant);
            // Stretched to 0 and 255; each is the whole of its set: (255 + 0) / 2 and (255 + 255) / 2.
            assert_eq!((red[60], red[180]), (127.5, 255.0));
            assert!(green[100] > 0.0);
        }
    }
}
