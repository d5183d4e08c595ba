//! The largest values of a plane.

use imaging::Plane;

use super::norm::range;
use crate::variant::Variant;

/// Values whose distances from the maximum agree to this many binary places are ties: windows with the same content
/// must tie, and running sums leave noise of 1e-13.
const EQUAL_BITS: i32 = 30;

/// Positions of the `count` largest values in descending order, or all positions if there are fewer. Values whose
/// distances from the maximum agree to 2^-30 tie; the earlier position wins. Values must be within ±2^32.
#[must_use]
pub fn largest(plane: &Plane<f64>, count: usize, variant: Variant) -> Vec<usize> {
    let mut chosen = match variant {
        Variant::Fast => candidates(plane, count),
        Variant::Reference => (0..plane.data().len()).collect(),
    };
    let top = chosen.iter().fold(f64::MIN, |top, &i| top.max(plane.data()[i]));
    chosen.sort_by_cached_key(|&i| {
        let rank = ((top - plane.data()[i]) * 2f64.powi(EQUAL_BITS)).round() as u64;
        (rank, i)
    });
    chosen.truncate(count);
    chosen
}

/// A few more positions than requested: all values above a bound found by a histogram.
fn candidates(plane: &Plane<f64>, count: usize) -> Vec<usize> {
    const BINS: usize = 4096;
    if plane.data().is_empty() {
        return Vec::new();
    }
    let (low, high) = range(plane.data());
    // A bin is at least as wide as a tie.
    let scale = ((BINS - 1) as f64 / (high - low)).min(2f64.powi(EQUAL_BITS));
    let bin = |value: f64| (((value - low) * scale) as usize).min(BINS - 1);
    let mut counts = [0usize; BINS];
    for &value in plane.data() {
        counts[bin(value)] += 1;
    }
    // One extra bin for values that round up into the selected ones.
    let mut bound = BINS;
    let mut held = 0;
    while held < count && bound > 0 {
        bound -= 1;
        held += counts[bound];
    }
    let bound = bound.saturating_sub(1);
    let values = plane.data().iter().enumerate();
    values
        .filter(|(_, value)| bin(**value) >= bound)
        .map(|(i, _)| i)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_come_in_the_order_of_their_positions() {
        let plane = Plane::new(6, 1, vec![1.0, 3.0, 2.0, 3.0, -1.0, 3.0]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(largest(&plane, 4, variant), [1, 3, 5, 2]);
            assert_eq!(largest(&plane, 2, variant), [1, 3]);
            assert_eq!(largest(&plane, 9, variant).len(), 6);
            assert_eq!(largest(&Plane::filled(3, 2, 7.0), 2, variant), [0, 1]);
        }
    }
}
