//! `POST /v1/jobs/{id}/retry-failed`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::JobRow;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::Jobs;

/// Try the failed frames of a job again.
///
/// Their failures are forgotten. A job that had ended with failures goes on.
#[utoipa::path(post, path = "/v1/jobs/{id}/retry-failed", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn retry_failed(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.retry_failed(id).await?))
}
