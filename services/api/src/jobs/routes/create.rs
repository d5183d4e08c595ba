//! `POST /v1/jobs`.

use axum::http::StatusCode;
use catalogue::JobRow;

use crate::http::extract::Submitter;
use crate::http::located::{Located, located};
use crate::http::{JsonBytes, Problem, State, Topic};
use crate::jobs::Jobs;
use crate::limits;
use crate::openapi::JobDescription;

/// Submit a job.
///
/// Everything is checked at once and all errors come together. The answer is given when the job is durable; its
/// frames are rendered afterwards. Repeating a submission with the same `Idempotency-Key` answers the same job.
#[utoipa::path(post, path = "/v1/jobs", tag = "jobs", operation_id = "submit_job",
    params(("Idempotency-Key" = Option<String>, Header, description = "1..=255 characters, kept per token")),
    request_body(content = JobDescription, content_type = "application/json"),
    responses(
        (status = 202, description = "Accepted and durable; `Location` is the job.", body = JobRow),
        (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(jobs): Topic<Jobs>,
    submitter: Submitter,
    JsonBytes(body): JsonBytes,
) -> Result<Located<JobRow>, Problem> {
    let job = jobs.parse(&body).await?;
    let warnings = job.warnings().to_vec();
    let row = jobs.submit(job, limits::JOB_PRIORITY, submitter).await?.row;
    let location = format!("/v1/jobs/{}", row.id);
    Ok(located(
        StatusCode::ACCEPTED,
        location,
        JobRow { warnings, ..row },
    ))
}
