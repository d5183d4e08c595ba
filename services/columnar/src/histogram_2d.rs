//! 2-D histograms: counts of pairs of values in a grid of cells.

use std::borrow::Cow;
use std::sync::Arc;

use crate::column::Column;
use crate::condition::Bound;
use crate::error::ColumnarError;
use crate::histogram::widened;
use crate::parts::{Masked, Query, Rows, Source};
use crate::sum::Sum;

/// The lowest and the highest edge of each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes {
    /// Along the width.
    pub x: (f64, f64),
    /// Along the height.
    pub y: (f64, f64),
}

/// A 2-D histogram.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram2d {
    /// The extent of the grid.
    pub axes: Axes,
    /// Pairs in each cell: those of the lowest y first, from the lowest x.
    pub counts: Vec<u64>,
    /// The mean of the third column in each cell.
    pub means: Option<Vec<Option<f64>>>,
    /// Rows without a finite value in one of the two.
    pub missing: u64,
    /// Where the rows came from.
    pub source: Source,
}

/// The smallest and the largest values.
#[derive(Debug, Clone, Copy)]
struct Ends {
    x: (f64, f64),
    y: (f64, f64),
    /// The largest magnitude of the third column.
    third: f64,
}

const NO_ENDS: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// A grid that is being filled.
struct Grid {
    axes: Axes,
    bins: usize,
    counts: Vec<u64>,
    /// Sums of the third column, and how many values are in each.
    thirds: Vec<(Sum, u64)>,
    counted: u64,
}

/// Counts the pairs of the first two columns in `bins` × `bins` cells of equal size, from the smallest finite value of each to the
/// largest; with a third column, its mean in each cell.
///
/// # Errors
/// [`ColumnarError`].
pub fn histogram_2d(query: &Query<'_>, bins: usize) -> Result<Histogram2d, ColumnarError> {
    let masked = Masked::new(query)?;
    let has_third = query.columns.len() > 2;
    let ends = ends(&masked, has_third)?;
    let empty = || Grid::new(&ends, bins, has_third);
    let mut all = empty();
    for part in masked.pass(empty, |grid, rows| {
        let columns = Triple::read(rows, has_third)?;
        let (x, y, third) = columns.numbers();
        rows.visit(x.len(), |at| {
            grid.add(x[at], y[at], third.as_ref().map(|third| third[at]));
        });
        Ok(())
    })? {
        all.merge(&part);
    }
    let rows = masked.source.files + masked.source.memory;
    Ok(all.finish(rows, masked.source, has_third))
}

type Numbers<'a> = Cow<'a, [f64]>;

/// The columns of some rows.
struct Triple(Arc<Column>, Arc<Column>, Option<Arc<Column>>);

impl Triple {
    fn read(rows: &Rows<'_>, has_third: bool) -> Result<Self, ColumnarError> {
        let third = has_third.then(|| rows.column(2)).transpose()?;
        Ok(Self(rows.column(0)?, rows.column(1)?, third))
    }

    fn numbers(&self) -> (Numbers<'_>, Numbers<'_>, Option<Numbers<'_>>) {
        (
            self.0.numbers(),
            self.1.numbers(),
            self.2.as_ref().map(|third| third.numbers()),
        )
    }
}

fn ends(masked: &Masked<'_>, has_third: bool) -> Result<Ends, ColumnarError> {
    let all = masked.pass(Ends::none, |ends, rows| {
        if let Some(known) = Ends::known(rows, has_third) {
            ends.merge(&known);
            return Ok(());
        }
        let columns = Triple::read(rows, has_third)?;
        let (x, y, third) = columns.numbers();
        rows.visit(x.len(), |at| {
            ends.add(x[at], y[at], third.as_ref().map(|third| third[at]));
        });
        Ok(())
    })?;
    let mut ends = Ends::none();
    all.iter().for_each(|part| ends.merge(part));
    Ok(ends)
}

impl Ends {
    fn none() -> Self {
        Self {
            x: NO_ENDS,
            y: NO_ENDS,
            third: 0.0,
        }
    }

    /// The bounds from the footer, for files whose rows are all in the query and have all values.
    fn known(rows: &Rows<'_>, has_third: bool) -> Option<Self> {
        let third = if has_third {
            known_ends(rows, 2)?
        } else {
            (0.0, 0.0)
        };
        Some(Self {
            x: known_ends(rows, 0)?,
            y: known_ends(rows, 1)?,
            third: third.0.abs().max(third.1.abs()),
        })
    }

    #[inline]
    fn add(&mut self, x: f64, y: f64, third: Option<f64>) {
        if x.is_finite() && y.is_finite() {
            self.x = (self.x.0.min(x), self.x.1.max(x));
            self.y = (self.y.0.min(y), self.y.1.max(y));
            if let Some(third) = third.filter(|third| third.is_finite()) {
                self.third = self.third.max(third.abs());
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        self.x = (self.x.0.min(other.x.0), self.x.1.max(other.x.1));
        self.y = (self.y.0.min(other.y.0), self.y.1.max(other.y.1));
        self.third = self.third.max(other.third);
    }
}

/// The finite ends of a column from the footer.
fn known_ends(rows: &Rows<'_>, column: usize) -> Option<(f64, f64)> {
    match rows.range(column).map(|range| (range.low, range.high)) {
        Some((Bound::Number(low), Bound::Number(high))) if low.is_finite() && high.is_finite() => {
            Some((low, high))
        }
        _ => None,
    }
}

#[inline]
fn bin((low, high): (f64, f64), value: f64, bins: usize) -> usize {
    let share = (value - low) / (high - low);
    ((share * bins as f64) as usize).min(bins - 1)
}

impl Grid {
    fn new(ends: &Ends, bins: usize, has_third: bool) -> Self {
        let thirds = if has_third { bins * bins } else { 0 };
        Self {
            axes: Axes {
                x: widened(ends.x),
                y: widened(ends.y),
            },
            bins,
            counts: vec![0; bins * bins],
            thirds: vec![(Sum::up_to(ends.third), 0); thirds],
            counted: 0,
        }
    }

    #[inline]
    fn add(&mut self, x: f64, y: f64, third: Option<f64>) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        let cell = bin(self.axes.y, y, self.bins) * self.bins + bin(self.axes.x, x, self.bins);
        self.counts[cell] += 1;
        self.counted += 1;
        if let Some(third) = third.filter(|third| third.is_finite()) {
            let (sum, count) = &mut self.thirds[cell];
            sum.add(third);
            *count += 1;
        }
    }

    fn merge(&mut self, other: &Self) {
        self.counted += other.counted;
        for (all, more) in self.counts.iter_mut().zip(&other.counts) {
            *all += more;
        }
        for ((sum, count), (more, known)) in self.thirds.iter_mut().zip(&other.thirds) {
            sum.merge(more);
            *count += known;
        }
    }

    fn finish(self, rows: u64, source: Source, has_third: bool) -> Histogram2d {
        Histogram2d {
            axes: self.axes,
            missing: rows - self.counted,
            counts: self.counts,
            means: has_third.then(|| {
                self.thirds
                    .iter()
                    .map(|(sum, count): &(Sum, u64)| (*count > 0).then(|| sum.total() / *count as f64))
                    .collect()
            }),
            source,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cache::Cache;
    use crate::column::{ColumnBuilder, Kind};
    use crate::parts::Part;

    /// The histogram of points, each with an optional third value.
    fn counted(points: &[(Option<f64>, f64, Option<f64>)], bins: usize, has_third: bool) -> Histogram2d {
        let mut columns = [(); 3].map(|()| ColumnBuilder::new(Kind::Number));
        for (x, y, third) in points {
            columns[0].number(*x);
            columns[1].number(Some(*y));
            columns[2].number(*third);
        }
        let columns = columns.into_iter().map(|column| Arc::new(column.build()));
        let names = ["x", "y", "third"].map(str::to_owned);
        let query = Query {
            parts: &[Part::Rows(columns.collect())],
            columns: if has_third { &names } else { &names[..2] },
            condition: None,
            cache: &Cache::new(0),
            threads: 1,
        };
        histogram_2d(&query, bins).unwrap()
    }

    #[test]
    fn every_pair_is_in_one_cell_and_the_last_edges_belong_to_the_last() {
        let points = [
            (Some(0.0), 0.0, Some(2.0)),
            (Some(0.1), 0.2, Some(4.0)),
            (None, 0.2, Some(4.0)),
            (Some(1.0), 2.0, None),
            (Some(0.9), 0.0, Some(1.0)),
        ];
        let got = counted(&points, 2, true);
        assert_eq!(got.counts, [2, 1, 0, 1]);
        assert_eq!(got.means, Some(vec![Some(3.0), Some(1.0), None, None]));
        assert_eq!((got.axes.y, got.missing), ((0.0, 2.0), 1));
    }

    #[test]
    fn values_that_are_all_the_same_still_have_a_cell() {
        let got = counted(&[(Some(5.0), 5.0, None)], 4, false);
        assert_eq!(got.counts.iter().sum::<u64>(), 1);
        assert!(counted(&[], 4, false).counts.iter().all(|count| *count == 0));
    }
}
