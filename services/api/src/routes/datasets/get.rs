//! `GET /v1/datasets/{name}`.

use axum::Json;
use axum::extract::State;

use super::list::Dataset;
use crate::extract::Path;
use crate::problem::Problem;
use crate::state::Shared;

/// See a dataset: its counts and bytes.
#[utoipa::path(get, path = "/v1/datasets/{name}", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "The dataset.", body = Dataset),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn get(
    State(app): State<Shared>,
    Path(name): Path<String>,
) -> Result<Json<Dataset>, Problem> {
    let mut rows = app.catalogue.datasets().await?.into_iter();
    let row = rows.find(|row| row.name == name);
    let row = row.ok_or_else(|| Problem::not_found(format!("no dataset `{name}`")))?;
    Ok(Json(row.into()))
}
