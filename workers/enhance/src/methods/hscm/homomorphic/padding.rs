//! Padded side lengths.

/// The least side of at least `n` (`n >= 1`) whose only prime factors are 2, 3 and 5.
#[must_use]
pub fn padded_side(n: usize) -> usize {
    let mut side = n.max(1);
    while !is_smooth(side) {
        side += 1;
    }
    side
}

fn is_smooth(mut side: usize) -> bool {
    for factor in [2, 3, 5] {
        while side.is_multiple_of(factor) {
            side /= factor;
        }
    }
    side == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_grow_to_the_next_product_of_two_three_and_five() {
        let padded = [1, 7, 11, 61, 97, 160, 565, 869].map(padded_side);
        assert_eq!(padded, [1, 8, 12, 64, 100, 160, 576, 900]);
    }
}
