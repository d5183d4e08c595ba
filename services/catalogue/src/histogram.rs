//! How the values of a column are spread over a dataset.

use columnar::Counts;
use futures::TryStreamExt;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::counting::{Asked, check_dataset, counted_source, number_column};
use crate::error::CatalogueError;
use crate::named::double;
use crate::select::Select;
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
                let selected = [number_column(&self.columns, column)?];
                let asked = Asked {
                    dataset,
                    columns: &selected,
                    filter,
                };
                let bins = bins as usize;
                let counted = self.count(&asked, move |question| columnar::histogram(question, bins, range));
                if let Some(counts) = counted.await? {
                    return Ok(shown(column, counts));
                }
                let mut reader = self.reader().await?;
                let (values, missing) = within(values(&mut reader, &self.columns, &asked)).await?;
                let mut counts = Counts::of(&values, missing, bins, range);
                counts.source.memory = values.len() as u64 + missing;
                return Ok(shown(column, counts));
            }
        };
        Err(CatalogueError::refused(message))
    }
}

/// The values of a column and how many rows have none.
async fn values(
    connection: &mut SqliteConnection,
    columns: &Columns,
    asked: &Asked<'_>,
) -> Result<(Vec<f64>, u64), CatalogueError> {
    check_dataset(connection, asked.dataset).await?;
    let sql = Select::new(columns, asked.columns, asked.filter, Some(asked.dataset))?;
    let (mut values, mut missing) = (Vec::new(), 0);
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        match double(&row, 0, asked.columns[0].kind)? {
            Some(value) => values.push(value),
            None => missing += 1,
        }
    }
    drop(rows);
    Ok((values, missing))
}

fn shown(column: &str, counts: Counts) -> Histogram {
    Histogram {
        column: column.to_owned(),
        edges: counts.edges,
        counts: counts.counts,
        below: counts.below,
        above: counts.above,
        missing: counts.missing,
        source: counted_source(counts.source),
    }
}
