//! `DELETE /v1/datasets/{name}`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::Deleted;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::Jobs;

/// Delete a dataset with all its jobs and images.
///
/// Jobs that have not ended keep it: cancel them first. The space comes back in the background. Scenes stay.
#[utoipa::path(delete, path = "/v1/datasets/{name}", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "It is gone.", body = Deleted),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn delete(
    State(jobs): State<Arc<Jobs>>,
    Path(name): Path<String>,
) -> Result<Json<Deleted>, Problem> {
    Ok(Json(jobs.delete_dataset(name).await?))
}
