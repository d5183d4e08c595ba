//! `DELETE /v1/jobs/{id}`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::Deleted;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::Jobs;

/// Delete a job with its images, whatever it is doing.
///
/// It is gone at once and for good; the space comes back in the background. Scenes stay.
#[utoipa::path(delete, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "It is gone.", body = Deleted)))]
pub(crate) async fn delete(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<Json<Deleted>, Problem> {
    Ok(Json(jobs.delete(id).await?))
}
