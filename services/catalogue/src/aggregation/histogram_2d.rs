//! 2-D histograms of two columns.

use client::CountedSource;
use columnar::Axes;
use serde::Serialize;
use utoipa::ToSchema;

use crate::aggregation::aggregate::{ImageSet, counted_source, number_column};
use crate::catalogue::Catalogue;
use crate::error::CatalogueError;

/// Upper limit for each axis: finer cells cannot be seen.
const MOST_BINS: u32 = 400;

/// Two columns of numbers, and a third whose mean colors the cells.
#[derive(Debug, Clone, Copy)]
pub struct Histogram2dColumns<'a> {
    /// Along the width.
    pub x: &'a str,
    /// Along the height.
    pub y: &'a str,
    /// Whose mean is given for each cell.
    pub mean_of: Option<&'a str>,
}

/// How the pairs of two columns are spread.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Density)]
pub struct Histogram2d {
    /// The column along the width.
    pub x: Histogram2dAxis,
    /// The column along the height.
    pub y: Histogram2dAxis,
    /// Cells along each axis.
    pub bins: usize,
    /// Images in each cell, `bins` × `bins`: those of the lowest `y` first, from the lowest `x`. The last cells have both of
    /// their edges.
    pub counts: Vec<u64>,
    /// The third column; absent if none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mean_of: Option<String>,
    /// Its mean in each cell, in the order of `counts`; null: no image of the cell has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub means: Option<Vec<Option<f64>>>,
    /// Images without a finite value in one of the two.
    pub missing: u64,
    /// Where the images were read.
    pub source: CountedSource,
}

/// A column and where its cells begin and end.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = DensityAxis)]
pub struct Histogram2dAxis {
    /// The column.
    pub column: String,
    /// The lowest edge.
    pub min: f64,
    /// The highest edge.
    pub max: f64,
}

impl Catalogue {
    /// Counts images in a grid of `bins` × `bins` cells of equal size, from the smallest finite value of each column to the
    /// largest.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for the dataset; [`CatalogueError::Filter`] for columns, filter and bins.
    pub async fn histogram_2d(
        &self,
        dataset: &str,
        filter: Option<&str>,
        columns: Histogram2dColumns<'_>,
        bins: u32,
    ) -> Result<Histogram2d, CatalogueError> {
        if !(1..=MOST_BINS).contains(&bins) {
            let message = format!("is {bins}; must be 1 to {MOST_BINS}");
            return Err(CatalogueError::refused_parameter("bins", &message));
        }
        let names = [
            Some(("x", columns.x)),
            Some(("y", columns.y)),
            columns.mean_of.map(|name| ("mean_of", name)),
        ];
        let selected = names
            .into_iter()
            .flatten()
            .map(|(parameter, name)| number_column(&self.columns, name, parameter))
            .collect::<Result<Vec<_>, _>>()?;
        let images = ImageSet {
            dataset,
            columns: &selected,
            filter,
        };
        let bins = bins as usize;
        let histogram = self.aggregate(&images, move |query| columnar::histogram_2d(query, bins));
        let histogram = histogram.await?;
        let Axes { x, y } = histogram.axes;
        Ok(Histogram2d {
            x: Histogram2dAxis::new(columns.x, x),
            y: Histogram2dAxis::new(columns.y, y),
            bins,
            counts: histogram.counts,
            mean_of: columns.mean_of.map(str::to_owned),
            means: histogram.means,
            missing: histogram.missing,
            source: counted_source(histogram.source),
        })
    }
}

impl Histogram2dAxis {
    fn new(column: &str, (min, max): (f64, f64)) -> Self {
        Self {
            column: column.to_owned(),
            min,
            max,
        }
    }
}
