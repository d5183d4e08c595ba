use std::sync::Arc;

use axum::response::Response;
use catalogue::FailureRow;
use serde_json::Value;

use crate::http::lines::stream_frames;
use crate::http::{Path, Problem, State, Topic};
use crate::jobs::Jobs;
use crate::limits::{RECORDS_BATCH, ROWS_BATCH};

/// Get the records of a job's images, in frame order.
///
/// Available in every state of the job; returns the records so far.
#[utoipa::path(get, path = "/v1/jobs/{id}/results", tag = "jobs", operation_id = "list_job_results",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "One record per line, as from `/v1/images/{job}/{frame}`.",
               content_type = "application/x-ndjson", body = String)))]
pub(crate) async fn results(State(jobs): Topic<Jobs>, Path(id): Path<String>) -> Result<Response, Problem> {
    jobs.get(&id).await?;
    stream_frames(
        RECORDS_BATCH,
        move |after| {
            let (catalogue, id) = (Arc::clone(&jobs.catalogue), id.clone());
            async move { catalogue.results(&id, after, RECORDS_BATCH).await }
        },
        |image: &Value| image["frame"].as_u64(),
    )
    .await
}

/// Get the failures of a job, in frame order.
///
/// Available in every state of the job; returns the failures so far.
#[utoipa::path(get, path = "/v1/jobs/{id}/errors", tag = "jobs", operation_id = "list_job_errors",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "One `Failure` per line.", content_type = "application/x-ndjson", body = String)))]
pub(crate) async fn errors(State(jobs): Topic<Jobs>, Path(id): Path<String>) -> Result<Response, Problem> {
    jobs.get(&id).await?;
    stream_frames(
        ROWS_BATCH,
        move |after| {
            let (catalogue, id) = (Arc::clone(&jobs.catalogue), id.clone());
            async move { catalogue.failures(&id, after, ROWS_BATCH).await }
        },
        |failure: &FailureRow| Some(failure.frame),
    )
    .await
}
