//! `GET /v1/jobs/{id}/errors`.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use catalogue::FailureRow;
use serde::Serialize;
use utoipa::ToSchema;

use crate::app::{App, Shared};
use crate::http::extract::Path;
use crate::http::lines::{self, Batch};
use crate::http::problem::Problem;
use crate::jobs::control::known;
use crate::limits::ROWS_BATCH;

/// A frame that failed.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Failure {
    /// The frame.
    pub(crate) frame: u64,
    /// Attempts that count against it.
    strikes: u32,
    /// Whether it was given up; otherwise it is tried again.
    given_up: bool,
    /// What the last attempt said.
    error: String,
}

impl From<FailureRow> for Failure {
    fn from(row: FailureRow) -> Self {
        Self {
            frame: row.frame,
            strikes: row.strikes,
            given_up: row.quarantined,
            error: row.error,
        }
    }
}

/// Read the failures of a job, in frame order.
///
/// Works in every state of the job: it answers what is there.
#[utoipa::path(get, path = "/v1/jobs/{id}/errors", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "One `Failure` a line.", content_type = "application/x-ndjson", body = String),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn errors(State(app): State<Shared>, Path(id): Path<String>) -> Result<Response, Problem> {
    known(&app, &id).await?;
    let first = batch(&app, &id, None).await?;
    Ok(lines::answer(lines::NDJSON, first, move |after| {
        let (app, id) = (Arc::clone(&app), id.clone());
        async move { batch(&app, &id, Some(after)).await }
    }))
}

async fn batch(app: &App, id: &str, after: Option<u64>) -> Result<Batch<u64>, Problem> {
    let failures = app.catalogue.failures(id, after, ROWS_BATCH).await?;
    let full = failures.len() == ROWS_BATCH as usize;
    let last = failures.last().map(|failure| failure.frame);
    Ok(Batch {
        bytes: lines::json_lines(failures.into_iter().map(Failure::from))?,
        next: last.filter(|_| full),
    })
}
