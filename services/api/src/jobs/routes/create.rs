use axum::http::StatusCode;
use catalogue::JobRow;
use serde::Deserialize;
use utoipa::IntoParams;

use crate::http::extract::Submitter;
use crate::http::located::{Located, located};
use crate::http::{JsonBytes, Problem, Query, State, Topic};
use crate::jobs::Jobs;
use crate::jobs::submit::Submission;
use crate::limits;
use crate::openapi::JobDescription;

/// Handling of a repeated description.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Render it although its dataset has every image of it; the dataset then has them twice.
    #[serde(default)]
    #[param(required = false, default = false)]
    again: bool,
}

/// Submit a job.
///
/// All errors of the description are reported together. The response is sent when the job is durable; its frames are
/// rendered afterwards. Repeating a submission with the same `Idempotency-Key` returns the same job. If the dataset
/// already has every image of the same description, the response is the existing job with a warning.
#[utoipa::path(post, path = "/v1/jobs", tag = "jobs", operation_id = "submit_job",
    params(("Idempotency-Key" = Option<String>, Header, description = "1..=255 characters, kept per token"), Parameters),
    request_body(content = JobDescription, content_type = "application/json"),
    responses(
        (status = 202, description = "Accepted and durable; `Location` is the job.", body = JobRow),
        (status = 200, description = "Nothing is rendered: the dataset has every image of this description, from the job of the \
            answer, whose `warnings` say so.", body = JobRow),
        (status = 409, response = crate::openapi::Problem),
        (status = 429, response = crate::openapi::Problem),
        (status = 502, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(jobs): Topic<Jobs>,
    submitter: Submitter,
    Query(query): Query<Parameters>,
    JsonBytes(body): JsonBytes,
) -> Result<Located<JobRow>, Problem> {
    let job = jobs.parse(&body).await?;
    let mut warnings = job.warnings().to_vec();
    let submission = Submission {
        submitter,
        priority: limits::JOB_PRIORITY,
        again: query.again,
    };
    let submitted = jobs.accept(job, submission).await?;
    let mut row = submitted.job.row;
    warnings.append(&mut row.warnings);
    let status = match submitted.is_complete {
        true => StatusCode::OK,
        false => StatusCode::ACCEPTED,
    };
    let location = format!("/v1/jobs/{}", row.id);
    Ok(located(status, location, JobRow { warnings, ..row }))
}
