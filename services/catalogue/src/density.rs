//! How the pairs of two columns are spread over a dataset.

use futures::TryStreamExt;
use serde::Serialize;
use sqlx::sqlite::SqliteConnection;
use utoipa::ToSchema;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::histogram::extent;
use crate::page::{column, double};
use crate::select::Select;
use crate::stats::check_dataset;

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

/// An image with both values.
struct Point {
    x: f64,
    y: f64,
    third: Option<f64>,
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
        let mut reader = self.reader().await?;
        let points = points(&mut reader, &self.columns, dataset, filter, asked);
        let (points, missing) = within(points).await?;
        Ok(counted(asked, bins, &points, missing))
    }
}

/// The images that have both values as finite numbers, and how many have not.
async fn points(
    connection: &mut SqliteConnection,
    columns: &Columns,
    dataset: &str,
    filter: Option<&str>,
    asked: DensityColumns<'_>,
) -> Result<(Vec<Point>, u64), CatalogueError> {
    check_dataset(connection, dataset).await?;
    let names = [Some(asked.x), Some(asked.y), asked.mean_of];
    let mut selected = Vec::new();
    for name in names.into_iter().flatten() {
        let column = column(columns, name)?;
        if !column.kind.is_number() {
            return Err(CatalogueError::refused(format!("`{name}` is no number")));
        }
        selected.push(column);
    }
    let sql = Select::new(columns, &selected, filter, Some(dataset))?;
    let (mut points, mut missing) = (Vec::new(), 0);
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        let value = |at: usize| match selected.get(at) {
            Some(column) => Ok::<_, CatalogueError>(double(&row, at, column.kind)?.filter(|v| v.is_finite())),
            None => Ok(None),
        };
        match value(0)?.zip(value(1)?) {
            Some((x, y)) => points.push(Point {
                x,
                y,
                third: value(2)?,
            }),
            None => missing += 1,
        }
    }
    Ok((points, missing))
}

fn counted(asked: DensityColumns<'_>, bins: u32, points: &[Point], missing: u64) -> Density {
    let axis = |name: &str, of: fn(&Point) -> f64| {
        let values: Vec<f64> = points.iter().map(of).collect();
        let (min, max) = extent(&values);
        DensityAxis {
            column: name.to_owned(),
            min,
            max,
        }
    };
    let (x, y) = (axis(asked.x, |point| point.x), axis(asked.y, |point| point.y));
    let bins = bins as usize;
    let place = |axis: &DensityAxis, value: f64| {
        let share = (value - axis.min) / (axis.max - axis.min);
        ((share * bins as f64) as usize).min(bins - 1)
    };
    let mut counts = vec![0_u64; bins * bins];
    let (mut sums, mut known) = (vec![0.0; bins * bins], vec![0_u64; bins * bins]);
    for point in points {
        let cell = place(&y, point.y) * bins + place(&x, point.x);
        counts[cell] += 1;
        if let Some(value) = point.third {
            sums[cell] += value;
            known[cell] += 1;
        }
    }
    let mean = |(sum, count): (f64, u64)| (count > 0).then(|| sum / count as f64);
    let means = asked
        .mean_of
        .map(|_| sums.into_iter().zip(known).map(mean).collect());
    Density {
        x,
        y,
        bins,
        counts,
        mean_of: asked.mean_of.map(str::to_owned),
        means,
        missing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASKED: DensityColumns<'_> = DensityColumns {
        x: "alpha",
        y: "uiqm",
        mean_of: Some("range_scale"),
    };

    #[test]
    fn every_pair_is_in_one_cell_and_the_last_edges_belong_to_the_last() {
        let point = |x, y, third| Point { x, y, third };
        let points = [
            point(0.0, 0.0, Some(2.0)),
            point(0.1, 0.2, Some(4.0)),
            point(1.0, 2.0, None),
            point(0.9, 0.0, Some(1.0)),
        ];
        let got = counted(ASKED, 2, &points, 3);
        assert_eq!(got.counts, [2, 1, 0, 1]);
        assert_eq!(got.means, Some(vec![Some(3.0), Some(1.0), None, None]));
        assert_eq!((got.y.min, got.y.max, got.missing), (0.0, 2.0, 3));
    }

    #[test]
    fn values_that_are_all_the_same_still_have_a_cell() {
        let same = Point {
            x: 5.0,
            y: 5.0,
            third: None,
        };
        let got = counted(ASKED, 4, &[same], 0);
        assert_eq!(got.counts.iter().sum::<u64>(), 1);
        assert!(counted(ASKED, 4, &[], 0).counts.iter().all(|count| *count == 0));
    }
}
