//! Sums whose rounding does not depend on the order of their terms.

/// Bits below the leading one of the largest term that are kept of each term: with 2^27 terms of 2^98 units each, the total stays
/// below 2^126.
const BITS: i32 = 98;
/// Bits of a double's significand.
const SIGNIFICAND: i32 = 52;

/// A sum of doubles as a whole number of units of 2^(e − 98), where 2^e ≤ the largest magnitude < 2^(e + 1). Terms of at least 2^-46
/// of the largest are added exactly, smaller ones to the nearest unit below, 10^-29 of the largest; only the total is rounded to
/// a double. So any split of the terms over threads, files and tables has the same sum. For up to 2^27 terms, finite ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sum {
    total: i128,
    /// Exponent of the unit.
    unit: i32,
}

impl Sum {
    /// An empty sum of terms of at most this magnitude.
    #[must_use]
    pub fn up_to(largest: f64) -> Self {
        Self {
            total: 0,
            unit: exponent(largest) - BITS,
        }
    }

    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        self.total += units(term, self.unit);
    }

    /// Adds a sum of other terms with the same largest magnitude.
    pub fn merge(&mut self, other: &Self) {
        self.total += other.total;
    }

    /// The total, rounded once.
    #[must_use]
    pub fn total(&self) -> f64 {
        scaled(self.total as f64, self.unit)
    }

    /// The sum of all terms.
    #[must_use]
    pub fn exact(terms: impl Iterator<Item = f64> + Clone) -> f64 {
        let mut sum = Self::up_to(terms.clone().fold(0.0, |most: f64, term| most.max(term.abs())));
        terms.for_each(|term| sum.add(term));
        sum.total()
    }
}

/// ⌊log₂⌋ of a magnitude, of 0 and of subnormal numbers that of the smallest normal one.
pub(crate) fn exponent(magnitude: f64) -> i32 {
    ((magnitude.to_bits() >> SIGNIFICAND) & 0x7ff).max(1) as i32 - 1023
}

/// A term as a whole number of units of 2^`unit`.
#[inline]
pub(crate) fn units(term: f64, unit: i32) -> i128 {
    let bits = term.to_bits();
    let biased = ((bits >> SIGNIFICAND) & 0x7ff) as i32;
    let leading = u64::from(biased > 0) << SIGNIFICAND;
    let significand = (leading | (bits & ((1 << SIGNIFICAND) - 1))) as i64;
    let signed = i128::from(if bits >> 63 == 1 {
        -significand
    } else {
        significand
    });
    let shift = biased.max(1) - 1023 - SIGNIFICAND - unit;
    if shift >= 0 {
        signed << shift
    } else {
        signed >> (-shift).min(127)
    }
}

/// Times a power of two, in steps that stay within doubles.
pub(crate) fn scaled(mut value: f64, mut exponent: i32) -> f64 {
    const STEP: i32 = 1000;
    while exponent.abs() > STEP {
        value *= 2f64.powi(STEP * exponent.signum());
        exponent -= STEP * exponent.signum();
    }
    value * 2f64.powi(exponent)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn cancellation_loses_nothing_within_the_range() {
        assert_eq!(Sum::exact([1e10, 1.0, -1e10, 1e-3].into_iter()), 1.001);
        assert_eq!(Sum::exact([0.1; 10].into_iter()), 1.0);
        assert_eq!(Sum::exact([0.0, -0.0].into_iter()), 0.0);
        assert_eq!(Sum::exact([f64::MAX, -f64::MAX, f64::MAX].into_iter()), f64::MAX);
        let tiny = f64::from_bits(1);
        assert_eq!(Sum::exact([tiny, tiny, tiny].into_iter()), 3.0 * tiny);
    }

    proptest! {
        #[test]
        fn no_order_and_no_split_changes_a_bit(terms in prop::collection::vec(-1e9f64..1e9, 1..200), split in 0usize..200) {
            let whole = Sum::exact(terms.iter().copied());
            let backwards = Sum::exact(terms.iter().rev().copied());
            let largest = terms.iter().fold(0.0, |most: f64, term| most.max(term.abs()));
            let (mut one, mut other) = (Sum::up_to(largest), Sum::up_to(largest));
            for (at, term) in terms.iter().enumerate() {
                if at < split { one.add(*term) } else { other.add(*term) }
            }
            one.merge(&other);
            prop_assert_eq!(whole.to_bits(), backwards.to_bits());
            prop_assert_eq!(whole.to_bits(), one.total().to_bits());
            let plain: f64 = terms.iter().sum();
            prop_assert!((whole - plain).abs() <= 1e-13 * largest * terms.len() as f64);
        }
    }
}
