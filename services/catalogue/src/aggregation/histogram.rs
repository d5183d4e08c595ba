//! Histograms of a column.

use crate::aggregation::aggregate::{ImageSet, counted_source, number_column};
use crate::catalogue::Catalogue;
use crate::error::CatalogueError;
use crate::types::Histogram;

/// Upper limit: wider histograms cannot be displayed.
const MOST_BINS: u32 = 4096;

impl Catalogue {
    /// Counts the values of a number column in bins of equal width: the first edge belongs to a bin, the last bin has both of its
    /// edges. Without a range, the bins extend from the smallest value to the largest.
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
        if !(1..=MOST_BINS).contains(&bins) {
            let message = format!("is {bins}; must be 1 to {MOST_BINS}");
            return Err(CatalogueError::refused_parameter("bins", &message));
        }
        if let Some((low, high)) = range
            && !(low < high && (high - low).is_finite())
        {
            return Err(CatalogueError::refused(format!(
                "the range {low} to {high} has no width"
            )));
        }
        let images = ImageSet {
            dataset,
            columns: &[number_column(&self.columns, column, "column")?],
            filter,
        };
        let bins = bins as usize;
        let counts = self.aggregate(&images, move |query| columnar::histogram(query, bins, range));
        let counts = counts.await?;
        Ok(Histogram {
            column: column.to_owned(),
            edges: counts.edges,
            counts: counts.counts,
            below: counts.below,
            above: counts.above,
            missing: counts.missing,
            source: counted_source(counts.source),
        })
    }
}
