//! UICM, colorfulness: spread of the opponent colors `RG = R - G` and `YB = (R + G) / 2 - B`, less their shift from
//! gray (Panetta, Gao and Agaian 2016, eq. 1-4).
//!
//! `UICM = -0.0268 sqrt(μ_RG² + μ_YB²) + 0.1586 sqrt(σ²_RG + σ²_YB)`, where μ omits the lowest tenth of the sorted
//! values (rounded up) and the highest tenth (rounded down), and σ² is the mean squared distance of all values from
//! that μ.
//!
//! `funie` drops one more value from the sum of μ but divides by the same number. `table1` rounds YB down.

use crate::work::{MetricInput, SharedPart};

/// UICM of the article.
pub(crate) fn panetta(work: &MetricInput) -> f64 {
    let Opponents { rg, yb } = &*work.part();
    uicm(rg.moments(0), yb.moments(0))
}

/// UICM with one value too few in the mean.
pub(crate) fn funie(work: &MetricInput) -> f64 {
    let Opponents { rg, yb } = &*work.part();
    uicm(rg.moments(1), yb.moments(1))
}

/// UICM with integral YB.
pub(crate) fn table1(work: &MetricInput) -> f64 {
    let Opponents { rg, yb } = &*work.part();
    uicm(rg.moments(0), yb.rounded_down().moments(0))
}

fn uicm(rg: TrimmedMoments, yb: TrimmedMoments) -> f64 {
    -0.0268 * (rg.mean * rg.mean + yb.mean * yb.mean).sqrt() + 0.1586 * (rg.variance + yb.variance).sqrt()
}

/// Histograms of a picture's opponent colors.
pub(crate) struct Opponents {
    rg: OpponentHistogram,
    yb: OpponentHistogram,
}

impl SharedPart for Opponents {
    fn new(work: &MetricInput) -> Self {
        let mut rg = vec![0u32; 511];
        let mut yb = vec![0u32; 1021];
        for [r, g, b] in work.picture().pixels() {
            // Widen before the subtraction: 8 bits would wrap around.
            let [r, g, b] = [r, g, b].map(usize::from);
            rg[255 + r - g] += 1;
            yb[510 + r + g - 2 * b] += 1;
        }
        Self {
            rg: OpponentHistogram {
                counts: rg,
                lowest: -255,
                step: 1.0,
            },
            yb: OpponentHistogram {
                counts: yb,
                lowest: -510,
                step: 0.5,
            },
        }
    }
}

/// Counts of the values `step · (lowest + bin)`.
struct OpponentHistogram {
    counts: Vec<u32>,
    lowest: i64,
    step: f64,
}

struct TrimmedMoments {
    mean: f64,
    variance: f64,
}

impl OpponentHistogram {
    /// The same with every half rounded down.
    fn rounded_down(&self) -> Self {
        let lowest = self.lowest.div_euclid(2);
        let mut counts = vec![0; self.counts.len() / 2 + 1];
        for (value, count) in (self.lowest..).zip(&self.counts) {
            counts[(value.div_euclid(2) - lowest) as usize] += count;
        }
        Self {
            counts,
            lowest,
            step: 1.0,
        }
    }

    /// Trimmed mean and the variance about it. `missing` further values are omitted from the sum, but not from its
    /// divisor. If the trimming leaves no values, as for one pixel, the plain mean is used.
    fn moments(&self, missing: u64) -> TrimmedMoments {
        let total: u64 = self.counts.iter().map(|&count| u64::from(count)).sum();
        let (below, above) = (total.div_ceil(10), total / 10);
        let kept = total - below - above;
        let sum = if kept > 0 {
            self.sum(below + missing, total - above)
        } else {
            self.sum(0, total)
        };
        let mean = sum as f64 / kept.max(1) as f64;
        let squares: f64 = (self.lowest..)
            .zip(&self.counts)
            .map(|(value, &count)| {
                let distance = value as f64 - mean;
                f64::from(count) * (distance * distance)
            })
            .sum();
        TrimmedMoments {
            mean: self.step * mean,
            variance: self.step * self.step * (squares / total as f64),
        }
    }

    /// Sum of the sorted values at positions `first..end`, in steps.
    fn sum(&self, first: u64, end: u64) -> i64 {
        let mut position = 0;
        let mut sum = 0;
        for (value, &count) in (self.lowest..).zip(&self.counts) {
            let next = position + u64::from(count);
            let inside = next.min(end).saturating_sub(position.max(first));
            sum += value * inside as i64;
            position = next;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;
    use crate::subject::Subject;

    fn ten() -> OpponentHistogram {
        // Values 0..10, each once.
        OpponentHistogram {
            counts: vec![1; 10],
            lowest: 0,
            step: 1.0,
        }
    }

    #[test]
    fn one_tenth_is_left_out_at_either_end() {
        let moments = ten().moments(0);
        // 1..=8 remain: mean 4.5; the squared distances of all ten sum to 82.5.
        assert_eq!(moments.mean, 4.5);
        assert_eq!(moments.variance, 8.25);
    }

    #[test]
    fn the_deep_learning_profile_sums_one_value_less() {
        // 2..=8 over 8.
        assert_eq!(ten().moments(1).mean, 35.0 / 8.0);
    }

    #[test]
    fn one_pixel_has_its_own_value_as_mean() {
        let single = OpponentHistogram {
            counts: vec![0, 0, 1],
            lowest: -1,
            step: 1.0,
        };
        for missing in [0, 1] {
            assert_eq!(
                (single.moments(missing).mean, single.moments(missing).variance),
                (1.0, 0.0)
            );
        }
    }

    #[test]
    fn halves_are_rounded_down_on_both_sides_of_zero() {
        // -1.5, -1, -0.5, 0, 0.5, 1 become -2, -1, -1, 0, 0, 1.
        let halves = OpponentHistogram {
            counts: vec![1; 6],
            lowest: -3,
            step: 0.5,
        };
        let rounded = halves.rounded_down();
        assert_eq!((rounded.lowest, rounded.counts), (-2, vec![1, 2, 2, 1]));
    }

    #[test]
    fn differences_do_not_wrap_around() {
        let picture = Rgb8::from_fn(2, 1, |x, _| if x == 0 { [0, 255, 255] } else { [255, 0, 0] });
        let Opponents { rg, yb } = Opponents::new(&MetricInput::new(&Subject::new(&picture)));
        assert_eq!((rg.counts[0], rg.counts[510]), (1, 1));
        assert_eq!((yb.counts[510 - 255], yb.counts[510 + 255]), (1, 1));
    }
}
