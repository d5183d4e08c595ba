use std::sync::Arc;

use axum::response::Response;
use catalogue::{FailureRow, FrameRows};

use crate::http::lines::{self, Batch, stream_frames};
use crate::http::{Path, Problem, State, Topic};
use crate::jobs::Jobs;
use crate::limits::{RECORDS_BATCH, ROWS_BATCH};

/// Get the records of a job's images, in frame order.
///
/// Available in every state of the job; returns the records so far. Damaged records are left out and named in the header
/// `Fathom-Damaged`. If one is found after the header was sent, the response is cut short; a repeated request leaves it out.
#[utoipa::path(get, path = "/v1/jobs/{id}/results", tag = "jobs", operation_id = "list_job_results",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "One record per line, as from `/v1/images/{job}/{frame}`.",
               content_type = "application/x-ndjson", body = String)))]
pub(crate) async fn results(State(jobs): Topic<Jobs>, Path(id): Path<String>) -> Result<Response, Problem> {
    jobs.get(&id).await?;
    let known = jobs.catalogue.damaged_images().into_iter();
    let known = known.filter(|damage| damage.image.job == id);
    let known = known.map(|damage| damage.what).collect();
    let first = records(jobs.catalogue.results(&id, None, RECORDS_BATCH).await?)?;
    Ok(lines::respond(lines::NDJSON, first, known, move |after| {
        let (catalogue, id) = (Arc::clone(&jobs.catalogue), id.clone());
        async move { records(catalogue.results(&id, Some(after), RECORDS_BATCH).await?) }
    }))
}

fn records(found: FrameRows) -> Result<Batch<u64>, Problem> {
    Ok(Batch {
        bytes: lines::json_lines(found.rows)?,
        next: found.next,
        damaged: found.damaged,
    })
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
