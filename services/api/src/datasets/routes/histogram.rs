//! `GET /v1/datasets/{name}/histogram`.

use axum::Json;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::app::Shared;
use crate::http::extract::{Path, Query};
use crate::http::problem::{Problem, Slug};
use crate::images::routes::list::checked_filter;

/// Which values, in how many bins.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// A column of numbers.
    #[param(example = "uiqm")]
    column: String,
    /// Bins of equal width, 1..=4096.
    #[param(default = 50, minimum = 1, maximum = 4096)]
    bins: Option<u32>,
    /// The first edge; together with `max`. Absent: the smallest value.
    min: Option<f64>,
    /// The last edge.
    max: Option<f64>,
    /// Only images that fulfil this.
    filter: Option<String>,
}

/// How the values of a column are spread.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Histogram {
    /// The column.
    column: String,
    /// Edges of the bins, one more than bins. The first edge of a bin belongs to it; the last bin has both.
    edges: Vec<f64>,
    /// Values in each bin.
    counts: Vec<u64>,
    /// Values below the first edge.
    below: u64,
    /// Values above the last edge.
    above: u64,
    /// Images without a value.
    missing: u64,
}

/// Count the values of a column in bins.
#[utoipa::path(get, path = "/v1/datasets/{name}/histogram", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "The bins.", body = Histogram),
              (status = 404, response = crate::openapi::Problem),
              (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn histogram(
    State(app): State<Shared>,
    Path(name): Path<String>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Histogram>, Problem> {
    let range = match (asked.min, asked.max) {
        (Some(min), Some(max)) => Some((min, max)),
        (None, None) => None,
        _ => {
            return Err(Problem::new(
                Slug::InvalidQuery,
                "give both `min` and `max`, or neither",
            ));
        }
    };
    let filter = checked_filter(asked.filter)?;
    let bins = asked.bins.unwrap_or(50);
    let found = app
        .catalogue
        .histogram(&name, filter.as_deref(), &asked.column, bins, range)
        .await?;
    Ok(Json(Histogram {
        column: found.column,
        edges: found.edges,
        counts: found.counts,
        below: found.below,
        above: found.above,
        missing: found.missing,
    }))
}
