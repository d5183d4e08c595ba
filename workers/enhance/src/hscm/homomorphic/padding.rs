//! Padded sides, and which sample of the picture stands at a padded position.

use crate::hscm::options::Profile;
use crate::reflect::reflected;

/// The least side of at least `n` (`n >= 1`) whose only prime factors are 2, 3 and 5.
#[must_use]
pub fn padded_side(n: usize) -> usize {
    let smooth = |mut side: usize| {
        for factor in [2, 3, 5] {
            while side.is_multiple_of(factor) {
                side /= factor;
            }
        }
        side == 1
    };
    let mut side = n.max(1);
    while !smooth(side) {
        side += 1;
    }
    side
}

/// The sample of `0..n` at position `i` of the padded side; `None` where the padding is 0 (table 1 profile).
#[inline]
pub(super) fn source(i: usize, n: usize, profile: Profile) -> Option<usize> {
    match profile {
        Profile::Standard => Some(reflected(i, n)),
        Profile::Table1 => (i < n).then_some(i),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_grow_to_the_next_product_of_two_three_and_five() {
        let padded = [1, 7, 11, 61, 97, 160, 565, 869].map(padded_side);
        assert_eq!(padded, [1, 8, 12, 64, 100, 160, 576, 900]);
    }

    #[test]
    fn table_1_pads_with_nothing() {
        assert_eq!(source(3, 3, Profile::Table1), None);
        assert_eq!(source(3, 3, Profile::Standard), Some(1));
    }
}
