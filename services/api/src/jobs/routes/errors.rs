//! `GET /v1/jobs/{id}/errors`.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use catalogue::FailureRow;

use crate::http::extract::Path;
use crate::http::lines::by_frame;
use crate::http::problem::Problem;
use crate::jobs::Jobs;
use crate::limits::ROWS_BATCH;

/// Read the failures of a job, in frame order.
///
/// Works in every state of the job: it answers what is there.
#[utoipa::path(get, path = "/v1/jobs/{id}/errors", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "One `Failure` a line.", content_type = "application/x-ndjson", body = String)))]
pub(crate) async fn errors(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    jobs.get(&id).await?;
    let read = move |after| {
        let (catalogue, id) = (Arc::clone(&jobs.catalogue), id.clone());
        async move { catalogue.failures(&id, after, ROWS_BATCH).await }
    };
    by_frame(ROWS_BATCH, read, |failure: &FailureRow| Some(failure.frame)).await
}
