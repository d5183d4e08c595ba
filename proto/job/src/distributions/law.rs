//! Distributions as pure functions of a uniform number u in [0, 1).
//!
//! The distribution at JSON pointer `p` of a job with seed `s` uses, for frame `i`, `u =
//! imaging::random::Stream::law(s, p).unit(i, 0)`. The pointer is its location in the description, so a distribution
//! inside the second value of a choice has a pointer such as `/water/choice/1/range_scale`. If a job mixes sites, the
//! pointer is relative to the site's description, so a site draws the same values with and without others. Submitted
//! and canonical description have the same pointers.
//!
//! Every function is plain IEEE double arithmetic in the order written, with transcendentals from `libm`: the same
//! bits on every machine. `tests/vectors/laws.json` holds known results.

use serde_json::{Map, Value};

use crate::normal::normal_quantile;

/// The keys that mark an object as a distribution.
pub const KEYS: [&str; 6] = ["choice", "grid", "int", "log_uniform", "normal", "uniform"];

/// The first key that marks this object as a distribution.
pub(crate) fn find_key(map: &Map<String, Value>) -> Option<&'static str> {
    KEYS.into_iter().find(|key| map.contains_key(*key))
}

/// The key allowed next to a distribution's key.
pub(crate) fn companion(key: &str) -> Option<&'static str> {
    match key {
        "choice" => Some("weights"),
        "normal" => Some("clip"),
        _ => None,
    }
}

/// Whether a value is written as a distribution.
pub(crate) fn is_law(value: &Value) -> bool {
    value.as_object().and_then(find_key).is_some()
}

/// Half of the spacing of u: `normal` evaluates at the middle of the cell of u.
const HALF_STEP: f64 = 1.0 / (1_u64 << 54) as f64;

/// The greatest double below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// a + (b − a)·u, at most b: rounding could exceed it by one unit in the last place.
#[must_use]
pub fn uniform(u: f64, a: f64, b: f64) -> f64 {
    (a + (b - a) * u).min(b)
}

/// exp(ln a + (ln b − ln a)·u) for 0 < a ≤ b, kept within a..=b.
#[must_use]
pub fn log_uniform(u: f64, a: f64, b: f64) -> f64 {
    let (from, to) = (libm::log(a), libm::log(b));
    libm::exp(from + (to - from) * u).max(a).min(b)
}

/// a + floor((b − a + 1)·u): whole numbers from a to b, both included, for |a|, |b| ≤ 2^53.
///
/// u has 2^53 equally likely values, so each number's probability is within 1 part in 2^53 / (b − a + 1) of uniform.
#[must_use]
pub fn int(u: f64, a: i64, b: i64) -> i64 {
    let count = (b - a) as f64 + 1.0;
    b.min(a + (count * u).floor() as i64)
}

/// mean + sd·z with Φ(z) = u + 2^-54, clamped to `low..=high`. u + 2^-54 is limited to the largest double below 1.
#[must_use]
pub fn normal(u: f64, mean: f64, sd: f64, low: f64, high: f64) -> f64 {
    let z = normal_quantile((u + HALF_STEP).min(BELOW_ONE));
    (mean + sd * z).max(low).min(high)
}

/// The first k with w_0 + … + w_k > u·(w_0 + … + w_n-1), sums from left to right. Weight 0 is never selected.
///
/// Without weights all are 1. Returns 0 for an empty list.
#[must_use]
pub fn choice(u: f64, weights: &[f64]) -> usize {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    weights
        .iter()
        .position(|weight: &f64| {
            sum += weight;
            sum > u * total
        })
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAST: f64 = BELOW_ONE;

    #[test]
    fn no_law_passes_its_upper_end() {
        for (a, b) in [(0.0, 1.0), (-0.1, 0.3), (1e-300, 0.7), (0.1, 0.1), (5.0, 1e17)] {
            for u in [0.0, 0.5, LAST] {
                assert!((a..=b).contains(&uniform(u, a, b)), "uniform {a} {b} {u}");
                if a > 0.0 {
                    assert!((a..=b).contains(&log_uniform(u, a, b)), "log_uniform {a} {b} {u}");
                }
            }
        }
        for b in [0, 1, 2, 6, 999_999, (1 << 53) - 1] {
            assert_eq!(int(LAST, 0, b), b);
            assert_eq!(int(0.0, -b, b), -b);
        }
    }

    #[test]
    fn log_uniform_has_its_middle_at_the_geometric_mean() {
        assert!((log_uniform(0.5, 0.01, 100.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn whole_numbers_share_the_unit_equally() {
        let steps = 7000;
        let mut counts = [0; 7];
        for k in 0..steps {
            counts[(int((f64::from(k) + 0.5) / f64::from(steps), -3, 3) + 3) as usize] += 1;
        }
        assert_eq!(counts, [1000; 7]);
    }

    #[test]
    fn normal_is_clamped_and_finite_at_both_ends() {
        assert_eq!(normal(0.0, 0.0, 1.0, -1.0, 2.0), -1.0);
        assert_eq!(normal(LAST, 0.0, 1.0, -1.0, 2.0), 2.0);
        assert_eq!(normal(LAST, 0.4, 0.0, 0.0, 1.0), 0.4);
        assert!(normal(LAST, 0.0, 1.0, -100.0, 100.0) < 8.3);
        assert!(normal(0.0, 0.0, 1.0, -100.0, 100.0) > -8.4);
    }

    #[test]
    fn weights_share_the_unit_and_zero_is_never_chosen() {
        let weights = [0.0, 1.0, 0.0, 3.0, 0.0];
        assert_eq!(choice(0.0, &weights), 1);
        assert_eq!(choice(0.249_999, &weights), 1);
        assert_eq!(choice(0.25, &weights), 3);
        assert_eq!(choice(LAST, &weights), 3);
        assert_eq!(choice(LAST, &[1.0; 3]), 2);
    }
}
