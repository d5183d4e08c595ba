//! Quantiles at both ends of a distribution.

use super::norm::range;
use crate::variant::Variant;

/// The values at positions `floor(share · K)` and `K - 1 - floor(share · K)` of the K sorted values, K at least 1. For
/// shares of 0.5 or more the first is above the second.
#[must_use]
pub fn tails(values: &[f64], share: f64, variant: Variant) -> (f64, f64) {
    let last = values.len() - 1;
    let below = ((share * values.len() as f64) as usize).min(last);
    match variant {
        Variant::Fast => {
            let counts = BinCounts::new(values);
            (counts.value(values, below), counts.value(values, last - below))
        }
        Variant::Reference => {
            let mut sorted = values.to_vec();
            sorted.sort_unstable_by(f64::total_cmp);
            (sorted[below], sorted[last - below])
        }
    }
}

const BINS: usize = 4096;

/// BinCounts of values in equal bins.
struct BinCounts {
    low: f64,
    scale: f64,
    bins: [usize; BINS],
}

impl BinCounts {
    fn new(values: &[f64]) -> Self {
        let (low, high) = range(values);
        let flat = high <= low;
        let mut counts = Self {
            low,
            scale: if flat {
                0.0
            } else {
                (BINS - 1) as f64 / (high - low)
            },
            bins: [0; BINS],
        };
        for &value in values {
            counts.bins[counts.bin(value)] += 1;
        }
        counts
    }

    #[inline(always)]
    fn bin(&self, value: f64) -> usize {
        (((value - self.low) * self.scale) as u32 as usize).min(BINS - 1)
    }

    /// The value at a position of the sorted values; sorts only the values of its bin.
    fn value(&self, values: &[f64], position: usize) -> f64 {
        let mut before = 0;
        let bin = self.bins.iter().position(|count| {
            before += count;
            before > position
        });
        let bin = bin.unwrap_or(BINS - 1);
        let values = values.iter().copied();
        let mut inside: Vec<f64> = values.filter(|&value| self.bin(value) == bin).collect();
        let position = position - (before - self.bins[bin]);
        *inside.select_nth_unstable_by(position, f64::total_cmp).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tails_are_values_at_positions() {
        let values: Vec<f64> = (0..200).map(|i| f64::from((i * 77) % 200)).collect();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(tails(&values, 0.01, variant), (2.0, 197.0));
            assert_eq!(tails(&values, 0.0, variant), (0.0, 199.0));
            assert_eq!(tails(&[4.0], 0.01, variant), (4.0, 4.0));
            assert_eq!(tails(&[4.0; 9], 0.2, variant), (4.0, 4.0));
        }
    }
}
