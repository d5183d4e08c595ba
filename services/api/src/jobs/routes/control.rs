//! `POST /v1/jobs/{id}/cancel`, `pause`, `resume` and `retry-failed`; `DELETE /v1/jobs/{id}`.

use catalogue::{Deleted, JobRow};

use crate::http::{Json, Path, Problem, State, Topic};
use crate::jobs::Jobs;

/// Cancel a job.
///
/// Its finished images stay. Workers drop what they are rendering of it with their next beat. Cancelling a job that
/// has ended changes nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/cancel", tag = "jobs", operation_id = "cancel_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow)))]
pub(crate) async fn cancel(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.cancel(id).await?))
}

/// Pause a job.
///
/// Workers get none of its frames until it is resumed; what they hold they finish. Pausing a paused job changes
/// nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/pause", tag = "jobs", operation_id = "pause_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn pause(State(jobs): Topic<Jobs>, Path(id): Path<String>) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.pause(id).await?))
}

/// Resume a paused job.
///
/// Resuming a job that is not paused but goes on changes nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/resume", tag = "jobs", operation_id = "resume_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn resume(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.resume(id).await?))
}

/// Try the failed frames of a job again.
///
/// Their failures are forgotten. A job that had ended with failures goes on.
#[utoipa::path(post, path = "/v1/jobs/{id}/retry-failed", tag = "jobs", operation_id = "retry_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn retry_failed(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.retry_failed(id).await?))
}

/// Delete a job with its images, whatever it is doing.
///
/// It is gone at once and for good; the space comes back in the background. Scenes stay.
#[utoipa::path(delete, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "delete_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "It is gone.", body = Deleted)))]
pub(crate) async fn delete(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<Deleted>, Problem> {
    Ok(Json(jobs.delete(id).await?))
}
