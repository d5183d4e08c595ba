//! Count, mean, deviation and quartiles of columns in groups, without holding their values.
//!
//! A pass finds the smallest and the largest value of each group, a second one counts values in fine bins and adds them up, and
//! a third one adds the squares and collects the values of the bins that contain quartiles. Where bins have no width, or there are
//! more groups than bins, the values of each group are collected and sorted instead.

mod sorting;
mod summary;

use self::sorting::by_sorting;
use crate::error::ColumnarError;
use crate::groups::{Cell, GroupBy, Grouped, grouped};
use crate::parts::{Masked, Query, Source};
use crate::sum::Sum;
pub use summary::Summary;
use summary::{Quantile, SHARES, Summaries, each_value};

/// Most bins of one group, and of all groups of a column: their counts fit into a core's cache.
const MOST_BINS: usize = 4096;
const ALL_BINS: usize = 1 << 15;
const LEAST_BINS: usize = 64;
/// Groups whose values are counted in bins; the values of more groups are sorted.
const MOST_BINNED_GROUPS: usize = 1000;

/// Count and bounds of a group's values.
#[derive(Debug, Clone, Copy)]
struct Ends {
    count: u64,
    low: f64,
    high: f64,
}

const NO_VALUES: Ends = Ends {
    count: 0,
    low: f64::INFINITY,
    high: f64::NEG_INFINITY,
};

/// Values of a group in bins, and their sum.
#[derive(Clone)]
struct Binned {
    counts: Vec<u32>,
    sum: Sum,
}

/// The squares of a group's deviations, and the values of its wanted bins.
#[derive(Clone)]
struct Gathered {
    squares: Sum,
    values: Vec<f64>,
}

/// The input of the third pass for a group.
struct Wanted {
    mean: f64,
    /// The bins with quartiles.
    bins: Vec<bool>,
    largest_square: f64,
}

/// A group: its key, and one summary for each column.
pub type Group = (Vec<Cell>, Vec<Summary>);

/// Statistics of the first `metrics` columns of the query for each group: its key, and one summary for each column. Groups are in
/// no order.
///
/// # Errors
/// [`ColumnarError::TooManyGroups`] for more than `most`; those of files.
pub fn stats(
    query: &Query<'_>,
    metrics: usize,
    by: &[GroupBy],
    most: Option<usize>,
) -> Result<(Vec<Group>, Source), ColumnarError> {
    let masked = Masked::new(query)?;
    let grouped = grouped(&masked, by, most)?;
    let columns = (0..metrics).map(|metric| of_column(&masked, &grouped, metric));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let groups = grouped.keys.into_iter().enumerate().map(|(group, key)| {
        let summaries = columns.iter().map(|column| column[group]).collect();
        (key, summaries)
    });
    Ok((groups.collect(), masked.source))
}

fn of_column(masked: &Masked<'_>, grouped: &Grouped, metric: usize) -> Result<Summaries, ColumnarError> {
    let groups = grouped.keys.len();
    if groups > MOST_BINNED_GROUPS {
        return by_sorting(masked, grouped, metric);
    }
    let bins = (ALL_BINS / groups.max(1)).clamp(LEAST_BINS, MOST_BINS);
    let ends = ends(masked, grouped, metric)?;
    if ends.iter().any(Ends::have_no_width) {
        return by_sorting(masked, grouped, metric);
    }
    let binned = binned(masked, grouped, metric, &ends, bins)?;
    let wanted: Vec<Wanted> = ends
        .iter()
        .zip(&binned)
        .map(|(ends, binned)| Wanted::new(ends, binned))
        .collect();
    let gathered = gathered(masked, grouped, metric, &ends, &wanted, bins)?;
    let all = ends.iter().zip(&binned).zip(&wanted).zip(gathered);
    Ok(all
        .map(|(((ends, binned), wanted), gathered)| summarized(ends, binned, wanted, gathered))
        .collect())
}

fn ends(masked: &Masked<'_>, grouped: &Grouped, metric: usize) -> Result<Vec<Ends>, ColumnarError> {
    use crate::condition::Bound;
    let groups = grouped.keys.len();
    let all = masked.pass(
        || vec![NO_VALUES; groups],
        |ends, rows| {
            if let (true, Some(known)) = (grouped.groups[rows.at].is_empty(), rows.range(metric))
                && let (Bound::Number(low), Bound::Number(high)) = (known.low, known.high)
            {
                ends[0].merge(&Ends {
                    count: rows.count(),
                    low,
                    high,
                });
                return Ok(());
            }
            each_value(rows, grouped, metric, |group, value| {
                ends[group].merge(&Ends {
                    count: 1,
                    low: value,
                    high: value,
                });
            })
        },
    )?;
    let mut ends = vec![NO_VALUES; groups];
    for part in all {
        ends.iter_mut().zip(&part).for_each(|(all, more)| all.merge(more));
    }
    Ok(ends)
}

impl Ends {
    #[inline]
    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    /// Whether bins between the ends have no width, as between infinite ones.
    fn have_no_width(&self) -> bool {
        self.count > 0 && !(self.high - self.low).is_finite()
    }

    fn largest(&self) -> f64 {
        if self.count == 0 {
            0.0
        } else {
            self.low.abs().max(self.high.abs())
        }
    }

    /// Bins for each unit; 0 where all values are in one.
    fn scale(&self, bins: usize) -> f64 {
        let scale = bins as f64 / (self.high - self.low);
        if scale.is_finite() { scale } else { 0.0 }
    }

    /// The bin of a value, which never falls as the value grows.
    #[inline]
    fn bin(&self, value: f64, scale: f64, bins: usize) -> usize {
        (((value - self.low) * scale) as usize).min(bins - 1)
    }
}

fn binned(
    masked: &Masked<'_>,
    grouped: &Grouped,
    metric: usize,
    ends: &[Ends],
    bins: usize,
) -> Result<Vec<Binned>, ColumnarError> {
    let scales: Vec<f64> = ends.iter().map(|ends| ends.scale(bins)).collect();
    let empty = || -> Vec<Binned> {
        ends.iter()
            .map(|ends: &Ends| Binned {
                counts: vec![0; bins],
                sum: Sum::up_to(ends.largest()),
            })
            .collect()
    };
    let mut all = empty();
    for part in masked.pass(empty, |binned, rows| {
        each_value(rows, grouped, metric, |group, value| {
            let bin = ends[group].bin(value, scales[group], bins);
            let binned = &mut binned[group];
            binned.counts[bin] += 1;
            binned.sum.add(value);
        })
    })? {
        for (all, more) in all.iter_mut().zip(&part) {
            all.sum.merge(&more.sum);
            for (all, more) in all.counts.iter_mut().zip(&more.counts) {
                *all += more;
            }
        }
    }
    Ok(all)
}

impl Wanted {
    fn new(ends: &Ends, binned: &Binned) -> Self {
        let mut bins = vec![false; binned.counts.len()];
        let places = SHARES
            .iter()
            .filter_map(|share| Quantile::new(*share, ends.count));
        let mut ranks: Vec<u64> = places.flat_map(|place| [place.low, place.high]).collect();
        ranks.sort_unstable();
        let (mut ranks, mut below) = (ranks.into_iter().peekable(), 0);
        // Equal values need no search.
        if ends.low < ends.high {
            for (bin, count) in binned.counts.iter().enumerate() {
                below += u64::from(*count);
                while ranks.next_if(|rank| *rank < below).is_some() {
                    bins[bin] = true;
                }
            }
        }
        let mean = if ends.count == 0 {
            0.0
        } else {
            binned.sum.total() / ends.count as f64
        };
        let largest = (ends.low - mean).abs().max((ends.high - mean).abs());
        Self {
            mean,
            bins,
            largest_square: if ends.count == 0 { 0.0 } else { largest * largest },
        }
    }
}

fn gathered(
    masked: &Masked<'_>,
    grouped: &Grouped,
    metric: usize,
    ends: &[Ends],
    wanted: &[Wanted],
    bins: usize,
) -> Result<Vec<Gathered>, ColumnarError> {
    let scales: Vec<f64> = ends.iter().map(|ends| ends.scale(bins)).collect();
    let empty = || -> Vec<Gathered> {
        wanted
            .iter()
            .map(|wanted: &Wanted| Gathered {
                squares: Sum::up_to(wanted.largest_square),
                values: Vec::new(),
            })
            .collect()
    };
    let mut all = empty();
    for part in masked.pass(empty, |gathered, rows| {
        each_value(rows, grouped, metric, |group, value| {
            let (wanted, gathered) = (&wanted[group], &mut gathered[group]);
            gathered
                .squares
                .add((value - wanted.mean) * (value - wanted.mean));
            if wanted.bins[ends[group].bin(value, scales[group], bins)] {
                gathered.values.push(value);
            }
        })
    })? {
        for (all, more) in all.iter_mut().zip(part) {
            all.squares.merge(&more.squares);
            all.values.extend(more.values);
        }
    }
    Ok(all)
}

fn summarized(ends: &Ends, binned: &Binned, wanted: &Wanted, mut gathered: Gathered) -> Summary {
    gathered.values.sort_unstable_by(f64::total_cmp);
    let value = |rank: u64| {
        if ends.low == ends.high {
            return ends.low;
        }
        // The rank among the collected values: without those in earlier bins that were not collected.
        let (mut below, mut skipped) = (0, 0);
        for (count, is_wanted) in binned.counts.iter().zip(&wanted.bins) {
            if rank < below + u64::from(*count) {
                break;
            }
            below += u64::from(*count);
            skipped += if *is_wanted { 0 } else { u64::from(*count) };
        }
        gathered.values[(rank - skipped) as usize]
    };
    let [q25, median, q75] = SHARES.map(|share| {
        let place = Quantile::new(share, ends.count)?;
        Some(place.between(value(place.low), value(place.high)))
    });
    let has_values = ends.count > 0;
    Summary {
        count: ends.count,
        mean: has_values.then_some(wanted.mean + 0.0),
        sd: (ends.count > 1).then(|| (gathered.squares.total() / (ends.count - 1) as f64).sqrt()),
        min: has_values.then_some(ends.low + 0.0),
        q25,
        median,
        q75,
        max: has_values.then_some(ends.high + 0.0),
    }
}

#[cfg(test)]
mod tests;
