//! Border reflection without repeating the edge: `d c b | a b c d | c b a`.

/// Reflects an index into `0..n`, at any distance. For `n = 1` it is always 0.
#[must_use]
pub fn reflected(i: isize, n: usize) -> usize {
    let period = (2 * n as isize - 2).max(1);
    let folded = i.rem_euclid(period);
    folded.min(period - folded) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_is_not_repeated_on_either_side() {
        let around: Vec<usize> = (-4..8).map(|i| reflected(i, 4)).collect();
        assert_eq!(around, [2, 3, 2, 1, 0, 1, 2, 3, 2, 1, 0, 1]);
    }

    #[test]
    fn one_sample_stands_for_all_and_two_alternate() {
        assert!([-3, -1, 0, 1, 7].into_iter().all(|i| reflected(i, 1) == 0));
        assert_eq!([-1, 0, 1, 2, 3].map(|i| reflected(i, 2)), [1, 0, 1, 0, 1]);
    }
}
