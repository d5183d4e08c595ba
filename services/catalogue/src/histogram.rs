//! How the values of a column are spread over a dataset.

use futures::TryStreamExt;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::page::{column, double};
use crate::select::Select;
use crate::stats::check_dataset;
use crate::types::Histogram;

/// Upper limit: wider histograms cannot be displayed.
const MOST_BINS: u32 = 4096;

impl Catalogue {
    /// Counts the values of a number column in bins of equal width: the first edge belongs to a bin, the last bin has
    /// both of its own. Without a range the bins go from the smallest value to the largest.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for the dataset; [`CatalogueError::Filter`] for column, filter, bins and range.
    pub async fn histogram(
        &self,
        dataset: &str,
        filter: Option<&str>,
        column: &str,
        bins: u32,
        range: Option<(f64, f64)>,
    ) -> Result<Histogram, CatalogueError> {
        let message = match range {
            _ if !(1..=MOST_BINS).contains(&bins) => format!("{bins} bins; there may be 1 to {MOST_BINS}"),
            Some((low, high)) if !(low < high && (high - low).is_finite()) => {
                format!("the range {low} to {high} has no width")
            }
            _ => {
                let mut reader = self.reader().await?;
                let values = values(&mut reader, &self.columns, dataset, filter, column);
                let (values, missing) = within(values).await?;
                return Ok(counted(column, bins, range, &values, missing));
            }
        };
        Err(CatalogueError::refused(message))
    }
}

/// The values of a column and how many rows have none.
async fn values(
    connection: &mut SqliteConnection,
    columns: &Columns,
    dataset: &str,
    filter: Option<&str>,
    name: &str,
) -> Result<(Vec<f64>, u64), CatalogueError> {
    check_dataset(connection, dataset).await?;
    let column = column(columns, name)?;
    if !column.kind.is_number() {
        return Err(CatalogueError::refused(format!("`{name}` is no number")));
    }
    let kind = column.kind;
    let sql = Select::new(columns, &[column], filter, Some(dataset))?;
    let (mut values, mut missing) = (Vec::new(), 0);
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        match double(&row, 0, kind)? {
            Some(value) => values.push(value),
            None => missing += 1,
        }
    }
    drop(rows);
    Ok((values, missing))
}

fn counted(column: &str, bins: u32, range: Option<(f64, f64)>, values: &[f64], missing: u64) -> Histogram {
    let (low, high) = range.unwrap_or_else(|| extent(values));
    let bins = bins as usize;
    let edge = |at: usize| {
        if at == bins {
            high
        } else {
            low + (high - low) * (at as f64 / bins as f64)
        }
    };
    let edges: Vec<f64> = (0..=bins).map(edge).collect();
    let mut counts = vec![0; bins];
    let (mut below, mut above) = (0, 0);
    for &value in values {
        if value < low {
            below += 1;
        } else if value > high {
            above += 1;
        } else {
            // Compared with the very edges that are returned, so that no rounding puts a value beside its bin.
            let bin = edges.partition_point(|&edge| edge <= value);
            counts[bin.clamp(1, bins) - 1] += 1;
        }
    }
    Histogram {
        column: column.to_owned(),
        edges,
        counts,
        below,
        above,
        missing,
    }
}

/// From the smallest finite value to the largest, and never without width.
pub(crate) fn extent(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        (0.0, 1.0)
    } else if low == high || !(high - low).is_finite() {
        (low - 0.5, high + 0.5)
    } else {
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_in_one_bin_and_the_last_edge_belongs_to_the_last() {
        let values = [0.0, 0.1, 0.3, 0.3, 0.5, 1.0, -1.0, 7.0, f64::INFINITY];
        let got = counted("uiqm", 10, Some((0.0, 1.0)), &values, 4);
        assert_eq!(got.counts, [1, 1, 0, 2, 0, 1, 0, 0, 0, 1]);
        assert_eq!((got.below, got.above, got.missing), (1, 2, 4));
        assert_eq!((got.edges.len(), got.edges[3], got.edges[10]), (11, 0.3, 1.0));
    }

    #[test]
    fn without_a_range_the_values_give_it_even_if_they_are_all_the_same_or_none() {
        let got = counted("x", 2, None, &[1.0, 2.0, 3.0], 0);
        assert_eq!((got.edges, got.counts), (vec![1.0, 2.0, 3.0], vec![1, 2]));
        let same = counted("x", 2, None, &[5.0, 5.0], 0);
        assert_eq!((same.edges, same.counts), (vec![4.5, 5.0, 5.5], vec![0, 2]));
        let none = counted("x", 1, None, &[], 3);
        assert_eq!(
            (none.edges, none.counts, none.missing),
            (vec![0.0, 1.0], vec![0], 3)
        );
    }
}
