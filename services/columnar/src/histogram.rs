//! Counts of a column's values between edges.

use crate::condition::Bound;
use crate::error::ColumnarError;
use crate::parts::{Masked, Query, Source};

/// Numbers of values between edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// One more than bins.
    pub edges: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<u64>,
    /// Values below the first edge.
    pub below: u64,
    /// Values above the last.
    pub above: u64,
    /// Rows without a value.
    pub missing: u64,
    /// Where the rows came from.
    pub source: Source,
}

/// Counts the values of the first column in bins of equal width: the first edge belongs to a bin, the last bin has both of its
/// edges. Without a range, the bins extend from the smallest finite value to the largest.
///
/// # Errors
/// [`ColumnarError`].
pub fn histogram(query: &Query<'_>, bins: usize, range: Option<(f64, f64)>) -> Result<Counts, ColumnarError> {
    let masked = Masked::new(query)?;
    let (low, high) = match range {
        Some(range) => range,
        None => widened(ends(&masked)?),
    };
    let edges = edges(low, high, bins);
    let mut all = Counts::empty(edges.clone());
    for part in masked.pass(
        || Counts::empty(edges.clone()),
        |counts, rows| {
            let column = rows.column(0)?;
            let values = column.numbers();
            rows.visit(values.len(), |at| counts.add(values[at]));
            Ok(())
        },
    )? {
        all.merge(&part);
    }
    all.source = masked.source;
    Ok(all)
}

/// The edges of bins of equal width.
fn edges(low: f64, high: f64, bins: usize) -> Vec<f64> {
    (0..=bins)
        .map(|at: usize| {
            if at == bins {
                high
            } else {
                low + (high - low) * (at as f64 / bins as f64)
            }
        })
        .collect()
}

impl Counts {
    fn empty(edges: Vec<f64>) -> Self {
        Self {
            counts: vec![0; edges.len() - 1],
            edges,
            below: 0,
            above: 0,
            missing: 0,
            source: Source::default(),
        }
    }

    /// Estimates the bin, then moves it until its edges enclose the value: no rounding puts a value outside of its bin.
    #[inline]
    fn add(&mut self, value: f64) {
        let bins = self.counts.len();
        let (low, high) = (self.edges[0], self.edges[bins]);
        if value >= low && value <= high {
            let mut bin = (((value - low) / (high - low) * bins as f64) as usize).min(bins - 1);
            while bin > 0 && self.edges[bin] > value {
                bin -= 1;
            }
            while bin + 1 < bins && self.edges[bin + 1] <= value {
                bin += 1;
            }
            self.counts[bin] += 1;
        } else if value < low {
            self.below += 1;
        } else if value > high {
            self.above += 1;
        } else {
            self.missing += 1;
        }
    }

    fn merge(&mut self, other: &Self) {
        self.below += other.below;
        self.above += other.above;
        self.missing += other.missing;
        for (all, more) in self.counts.iter_mut().zip(&other.counts) {
            *all += more;
        }
    }
}

/// The smallest and the largest finite value.
fn ends(masked: &Masked<'_>) -> Result<(f64, f64), ColumnarError> {
    let all = masked.pass(
        || (f64::INFINITY, f64::NEG_INFINITY),
        |ends, rows| {
            if let Some(known) = rows.range(0)
                && let (Bound::Number(low), Bound::Number(high)) = (known.low, known.high)
                && low.is_finite()
                && high.is_finite()
            {
                *ends = (ends.0.min(low), ends.1.max(high));
                return Ok(());
            }
            let column = rows.column(0)?;
            let values = column.numbers();
            rows.visit(values.len(), |at| {
                if values[at].is_finite() {
                    *ends = (ends.0.min(values[at]), ends.1.max(values[at]));
                }
            });
            Ok(())
        },
    )?;
    Ok(all
        .into_iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |one, other| {
            (one.0.min(other.0), one.1.max(other.1))
        }))
}

/// An extent that has a width; zero has no sign in it.
pub(crate) fn widened((low, high): (f64, f64)) -> (f64, f64) {
    if low > high {
        (0.0, 1.0)
    } else if low == high || !(high - low).is_finite() {
        (low - 0.5, high + 0.5)
    } else {
        (low + 0.0, high + 0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::cache::Cache;
    use crate::column::{ColumnBuilder, Kind};
    use crate::parts::Part;

    /// The counts of values and of this many rows without one.
    fn counted(values: &[f64], missing: usize, bins: usize, range: Option<(f64, f64)>) -> Counts {
        let mut column = ColumnBuilder::new(Kind::Number);
        values.iter().for_each(|value| column.number(Some(*value)));
        (0..missing).for_each(|_| column.number(None));
        let query = Query {
            parts: &[Part::Rows(vec![Arc::new(column.build())])],
            columns: &["uiqm".to_owned()],
            condition: None,
            cache: &Cache::new(0),
            threads: 1,
        };
        histogram(&query, bins, range).unwrap()
    }

    impl Counts {
        /// The reference: searches the edges.
        fn add_by_search(&mut self, value: f64) {
            let bins = self.counts.len();
            if value < self.edges[0] {
                self.below += 1;
            } else if value > self.edges[bins] {
                self.above += 1;
            } else {
                let bin = self.edges.partition_point(|&edge| edge <= value);
                self.counts[bin.clamp(1, bins) - 1] += 1;
            }
        }
    }

    #[test]
    fn every_value_is_in_one_bin_and_the_last_edge_belongs_to_the_last() {
        let values = [0.0, 0.1, 0.3, 0.3, 0.5, 1.0, -1.0, 7.0, f64::INFINITY];
        let got = counted(&values, 4, 10, Some((0.0, 1.0)));
        assert_eq!(got.counts, [1, 1, 0, 2, 0, 1, 0, 0, 0, 1]);
        assert_eq!((got.below, got.above, got.missing), (1, 2, 4));
        assert_eq!((got.edges.len(), got.edges[3], got.edges[10]), (11, 0.3, 1.0));
    }

    #[test]
    fn without_a_range_the_values_give_it_even_if_they_are_all_the_same_or_none() {
        let got = counted(&[1.0, 2.0, 3.0], 0, 2, None);
        assert_eq!((got.edges, got.counts), (vec![1.0, 2.0, 3.0], vec![1, 2]));
        let same = counted(&[5.0, 5.0], 0, 2, None);
        assert_eq!((same.edges, same.counts), (vec![4.5, 5.0, 5.5], vec![0, 2]));
        let none = counted(&[], 3, 1, None);
        assert_eq!(
            (none.edges, none.counts, none.missing),
            (vec![0.0, 1.0], vec![0], 3)
        );
    }

    proptest! {
        #[test]
        fn an_estimated_bin_is_the_searched_one(low in -1e3f64..1e3, width in 1e-9f64..1e6, bins in 1usize..300,
                                               shares in prop::collection::vec(-0.1f64..1.1, 1..50)) {
            let mut reference = Counts::empty(edges(low, low + width, bins));
            let mut fast = reference.clone();
            let values = shares.iter().map(|share| low + share * width).chain(reference.edges.clone());
            for value in values.collect::<Vec<_>>() {
                reference.add_by_search(value);
                fast.add(value);
            }
            prop_assert_eq!(reference, fast);
        }
    }
}
