//! `POST /v1/jobs`.

use axum::extract::State;
use axum::http::{HeaderName, StatusCode, header};
use axum::{Extension, Json};
use spec::Job;

use crate::app::Shared;
use crate::http::auth::Caller;
use crate::http::extract::{IdempotencyKey, JsonBytes};
use crate::http::problem::Problem;
use crate::jobs::submit::{Submission, submit};
use crate::jobs::view::JobView;
use crate::limits;
use crate::openapi::JobDescription;

/// Submit a job.
///
/// Everything is checked at once and all errors come together. The answer is given when the job is durable; its
/// frames are rendered afterwards. Repeating a submission with the same `Idempotency-Key` answers the same job.
#[utoipa::path(post, path = "/v1/jobs", tag = "jobs",
    params(("Idempotency-Key" = Option<String>, Header, description = "1..=255 characters, kept per token")),
    request_body(content = JobDescription, content_type = "application/json"),
    responses(
        (status = 202, description = "Accepted and durable; `Location` is the job.", body = JobView),
        (status = 409, response = crate::openapi::Problem),
        (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(app): State<Shared>,
    Extension(caller): Extension<Caller>,
    key: Option<IdempotencyKey>,
    JsonBytes(body): JsonBytes,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<JobView>), Problem> {
    let job = Job::parse(&body, &app.vocabulary())?;
    let warnings = job.warnings().to_vec();
    let idempotency_key = key.map(|IdempotencyKey(key)| key);
    let row = submit(
        &app,
        Submission {
            job,
            priority: limits::JOB_PRIORITY,
            caller,
            idempotency_key,
        },
    )
    .await?;
    let location = [(header::LOCATION, format!("/v1/jobs/{}", row.id))];
    Ok((StatusCode::ACCEPTED, location, Json(JobView::new(row, &warnings))))
}
