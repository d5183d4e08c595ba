//! Continuation of a picture beyond its border by reflection without repeating the edge: `d c b | a b c d | c b a`.

/// The index inside `0..n` that stands for `i`, any distance outside. One sample (`n = 1`) stands for all.
pub(crate) fn reflected(i: usize, n: usize) -> usize {
    if n == 1 {
        return 0;
    }
    let period = 2 * n - 2;
    let folded = i % period;
    folded.min(period - folded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_sample_is_not_repeated() {
        let seen: Vec<usize> = (0..9).map(|i| reflected(i, 3)).collect();
        assert_eq!(seen, [0, 1, 2, 1, 0, 1, 2, 1, 0]);
    }

    #[test]
    fn one_sample_continues_as_itself() {
        assert_eq!(reflected(17, 1), 0);
    }
}
