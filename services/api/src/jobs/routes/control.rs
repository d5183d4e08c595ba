use catalogue::{Deleted, JobRow};

use crate::http::{Json, Path, Problem, State, Topic};
use crate::jobs::Jobs;

/// Cancel a job.
///
/// Its finished images are kept. Workers drop its frames with their next heartbeat. Cancelling a job that has ended
/// has no effect.
#[utoipa::path(post, path = "/v1/jobs/{id}/cancel", tag = "jobs", operation_id = "cancel_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The present state of the job.", body = JobRow)))]
pub(crate) async fn cancel(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.cancel(id).await?))
}

/// Pause a job.
///
/// Workers finish their leased frames and receive no more until it is resumed. Pausing a paused job has no effect.
#[utoipa::path(post, path = "/v1/jobs/{id}/pause", tag = "jobs", operation_id = "pause_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The present state of the job.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn pause(State(jobs): Topic<Jobs>, Path(id): Path<String>) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.pause(id).await?))
}

/// Resume a paused job.
///
/// Resuming a job that is not paused has no effect.
#[utoipa::path(post, path = "/v1/jobs/{id}/resume", tag = "jobs", operation_id = "resume_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The present state of the job.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn resume(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.resume(id).await?))
}

/// Retry the failed frames of a job.
///
/// Their failures are discarded. A job that ended with failures resumes.
#[utoipa::path(post, path = "/v1/jobs/{id}/retry-failed", tag = "jobs", operation_id = "retry_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The present state of the job.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn retry_failed(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.retry_failed(id).await?))
}

/// Finish a job on machines of any kind.
///
/// By default all frames of a job come from the version and kind of machine that the service can check byte by byte. After
/// this, workers of any version, CPU features and ONNX Runtime render the remaining frames. The provenance of each image
/// states its origin, and frames that cannot be checked count as `unproven`.
#[utoipa::path(post, path = "/v1/jobs/{id}/finish-elsewhere", tag = "jobs", operation_id = "finish_job_elsewhere",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The present state of the job.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn finish_elsewhere(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.finish_elsewhere(id).await?))
}

/// Start a job again.
///
/// Its images are removed and all frames are rendered from the beginning, by one version on one kind of machine. A
/// cancelled, sealed or imported job is rejected.
#[utoipa::path(post, path = "/v1/jobs/{id}/start-again", tag = "jobs", operation_id = "start_job_again",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The present state of the job.", body = JobRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn start_again(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<JobRow>, Problem> {
    Ok(Json(jobs.start_again(id).await?))
}

/// Delete a job with its images in any state.
///
/// Deletion is immediate and permanent; space is reclaimed in the background. Scenes are kept.
#[utoipa::path(delete, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "delete_job",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "Deleted.", body = Deleted)))]
pub(crate) async fn delete(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<Deleted>, Problem> {
    Ok(Json(jobs.delete(id).await?))
}
