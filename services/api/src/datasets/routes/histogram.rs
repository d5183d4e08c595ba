use crate::http::{Json, Path, Problem, Query, Slug, State, Topic, bounds};

use catalogue::{Catalogue, Histogram};
use serde::Deserialize;
use utoipa::IntoParams;

/// Column and bins.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// A numeric column listed by `GET /v1/datasets/{name}`.
    #[param(example = "uiqm")]
    column: String,
    /// Bins of equal width, 1..=4096.
    #[param(default = 50, minimum = 1, maximum = 4096)]
    bins: Option<u32>,
    /// Lower edge; requires `max`. Absent: the smallest value.
    min: Option<f64>,
    /// Upper edge.
    max: Option<f64>,
    /// Only images that match this filter.
    filter: Option<String>,
}

/// Get a histogram of a column.
#[utoipa::path(get, path = "/v1/datasets/{name}/histogram", tag = "datasets", operation_id = "get_histogram",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "The bins.", body = Histogram),
              (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn histogram(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Json<Histogram>, Problem> {
    let range = query.min.zip(query.max);
    if range.is_none() && (query.min.is_some() || query.max.is_some()) {
        let detail = "give both `min` and `max`, or neither";
        return Err(Problem::new(Slug::InvalidQuery, detail));
    }
    let filter = bounds::check_filter(query.filter)?;
    let bins = query.bins.unwrap_or(50);
    let histogram = catalogue.histogram(&name, filter.as_deref(), &query.column, bins, range);
    Ok(Json(histogram.await?))
}
