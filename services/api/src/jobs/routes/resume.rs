//! `POST /v1/jobs/{id}/resume`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::JobRow;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::Jobs;

/// Resume a paused job.
///
/// Resuming a job that is not paused but goes on changes nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/resume", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn resume(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.resume(id).await?))
}
