//! `GET /v1/datasets/{name}/density`.

use crate::http::{Json, Path, Problem, Query, State, Topic, bounds};

use catalogue::{Catalogue, Histogram2d, Histogram2dColumns};
use serde::Deserialize;
use utoipa::IntoParams;

/// Which two columns, in how many cells.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// A column of numbers, of those that `GET /v1/datasets/{name}` lists.
    #[param(example = "alpha")]
    x: String,
    /// Another one.
    #[param(example = "uiqm")]
    y: String,
    /// A third one, whose mean is given for each cell.
    #[param(example = "water.range_scale")]
    mean_of: Option<String>,
    /// Cells along each axis, 1..=400.
    #[param(default = 64, minimum = 1, maximum = 400)]
    bins: Option<u32>,
    /// Only images that fulfill this.
    filter: Option<String>,
}

/// Count the pairs of two columns in cells.
#[utoipa::path(get, path = "/v1/datasets/{name}/density", tag = "datasets", operation_id = "get_density",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "The cells.", body = Histogram2d),
              (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn density(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Histogram2d>, Problem> {
    let filter = bounds::filter(asked.filter)?;
    let columns = Histogram2dColumns {
        x: &asked.x,
        y: &asked.y,
        mean_of: asked.mean_of.as_deref(),
    };
    let density = catalogue.histogram_2d(&name, filter.as_deref(), columns, asked.bins.unwrap_or(64));
    Ok(Json(density.await?))
}
