//! `POST /v1/jobs/{id}/pause`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::JobRow;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::Jobs;

/// Pause a job.
///
/// Workers get none of its frames until it is resumed; what they hold they finish. Pausing a paused job changes
/// nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/pause", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn pause(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.pause(id).await?))
}
