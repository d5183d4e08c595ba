use crate::http::{Json, Path, Problem, Query, State, Topic, bounds};

use catalogue::{Catalogue, Histogram2d, Histogram2dColumns};
use serde::Deserialize;
use utoipa::IntoParams;

/// Columns and number of cells.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// A numeric column listed by `GET /v1/datasets/{name}`.
    #[param(example = "alpha")]
    x: String,
    /// Another numeric column.
    #[param(example = "uiqm")]
    y: String,
    /// A third numeric column, averaged per cell.
    #[param(example = "water.range_scale")]
    mean_of: Option<String>,
    /// Cells along each axis, 1..=400.
    #[param(default = 64, minimum = 1, maximum = 400)]
    bins: Option<u32>,
    /// Only images that match this filter.
    filter: Option<String>,
}

/// Get a 2-D histogram of two columns.
#[utoipa::path(get, path = "/v1/datasets/{name}/density", tag = "datasets", operation_id = "get_density",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "The cells.", body = Histogram2d),
              (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn density(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Json<Histogram2d>, Problem> {
    let filter = bounds::check_filter(query.filter)?;
    let columns = Histogram2dColumns {
        x: &query.x,
        y: &query.y,
        mean_of: query.mean_of.as_deref(),
    };
    let density = catalogue.histogram_2d(&name, filter.as_deref(), columns, query.bins.unwrap_or(64));
    Ok(Json(density.await?))
}
