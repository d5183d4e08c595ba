//! `POST /v1/jobs/{id}/cancel`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::JobRow;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::Jobs;

/// Cancel a job.
///
/// Its finished images stay. Workers drop what they are rendering of it with their next beat. Cancelling a job that
/// has ended changes nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/cancel", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow)))]
pub(crate) async fn cancel(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.cancel(id).await?))
}
