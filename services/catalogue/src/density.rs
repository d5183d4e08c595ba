//! How the pairs of two columns are spread over a dataset.

use client::CountedSource;
use columnar::Cells;
use futures::TryStreamExt;
use serde::Serialize;
use sqlx::sqlite::SqliteConnection;
use utoipa::ToSchema;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::counting::{Asked, check_dataset, counted_source, number_column};
use crate::error::CatalogueError;
use crate::named::double;
use crate::select::Select;

/// Upper limit for each axis: finer cells cannot be seen.
const MOST_BINS: u32 = 400;

/// Two columns of numbers, and a third whose mean colors the cells.
#[derive(Debug, Clone, Copy)]
pub struct DensityColumns<'a> {
    /// Along the width.
    pub x: &'a str,
    /// Along the height.
    pub y: &'a str,
    /// Whose mean is given for each cell.
    pub mean_of: Option<&'a str>,
}

/// How the pairs of two columns are spread.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Density {
    /// The column along the width.
    pub x: DensityAxis,
    /// The column along the height.
    pub y: DensityAxis,
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
pub struct DensityAxis {
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
    pub async fn density(
        &self,
        dataset: &str,
        filter: Option<&str>,
        asked: DensityColumns<'_>,
        bins: u32,
    ) -> Result<Density, CatalogueError> {
        if !(1..=MOST_BINS).contains(&bins) {
            let message = format!("{bins} bins; there may be 1 to {MOST_BINS}");
            return Err(CatalogueError::refused(message));
        }
        let names = [Some(asked.x), Some(asked.y), asked.mean_of]
            .into_iter()
            .flatten();
        let selected = names.map(|name| number_column(&self.columns, name));
        let selected = selected.collect::<Result<Vec<_>, _>>()?;
        let question = Asked {
            dataset,
            columns: &selected,
            filter,
        };
        let bins = bins as usize;
        let counted = self.count(&question, move |question| columnar::density(question, bins));
        if let Some(cells) = counted.await? {
            return Ok(shown(asked, bins, cells));
        }
        let mut reader = self.reader().await?;
        let points = points(&mut reader, &self.columns, &question);
        let (points, missing) = within(points).await?;
        let mut cells = Cells::of(&points, missing, bins, asked.mean_of.is_some());
        cells.source.memory = points.len() as u64 + missing;
        Ok(shown(asked, bins, cells))
    }
}

/// An image with both values, and the third.
type Point = (f64, f64, Option<f64>);

/// The images that have both values as finite numbers, and how many have not.
async fn points(
    connection: &mut SqliteConnection,
    columns: &Columns,
    asked: &Asked<'_>,
) -> Result<(Vec<Point>, u64), CatalogueError> {
    check_dataset(connection, asked.dataset).await?;
    let sql = Select::new(columns, asked.columns, asked.filter, Some(asked.dataset))?;
    let (mut points, mut missing) = (Vec::new(), 0);
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        let value = |at: usize| match asked.columns.get(at) {
            Some(column) => Ok::<_, CatalogueError>(double(&row, at, column.kind)?.filter(|v| v.is_finite())),
            None => Ok(None),
        };
        match value(0)?.zip(value(1)?) {
            Some((x, y)) => points.push((x, y, value(2)?)),
            None => missing += 1,
        }
    }
    Ok((points, missing))
}

fn shown(asked: DensityColumns<'_>, bins: usize, cells: Cells) -> Density {
    let axis = |name: &str, (min, max): (f64, f64)| DensityAxis {
        column: name.to_owned(),
        min,
        max,
    };
    Density {
        x: axis(asked.x, cells.axes.x),
        y: axis(asked.y, cells.axes.y),
        bins,
        counts: cells.counts,
        mean_of: asked.mean_of.map(str::to_owned),
        means: cells.means,
        missing: cells.missing,
        source: counted_source(cells.source),
    }
}
