//! `DELETE /v1/datasets/{name}`.

use axum::Json;
use axum::extract::State;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::control;
use crate::jobs::routes::delete::DeletedView;

/// Delete a dataset with all its jobs and images.
///
/// Jobs that have not ended keep it: cancel them first. The space comes back in the background. Scenes stay.
#[utoipa::path(delete, path = "/v1/datasets/{name}", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "It is gone.", body = DeletedView),
              (status = 404, response = crate::openapi::Problem),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn delete(
    State(app): State<Shared>,
    Path(name): Path<String>,
) -> Result<Json<DeletedView>, Problem> {
    Ok(Json(control::delete_dataset(&app, name).await?.into()))
}
