//! `GET /v1/jobs/{id}/results`.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use serde_json::Value;

use crate::app::{App, Shared};
use crate::http::extract::Path;
use crate::http::lines::{self, Batch};
use crate::http::problem::Problem;
use crate::images::view;
use crate::jobs::control::known;
use crate::limits::RECORDS_BATCH;

/// Read the records of a job's images, in frame order.
///
/// Works in every state of the job: it answers what is there.
#[utoipa::path(get, path = "/v1/jobs/{id}/results", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "One record a line, as `/v1/images/{job}/{frame}` answers it.",
               content_type = "application/x-ndjson", body = String),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn results(State(app): State<Shared>, Path(id): Path<String>) -> Result<Response, Problem> {
    known(&app, &id).await?;
    let first = batch(&app, &id, None).await?;
    Ok(lines::answer(lines::NDJSON, first, move |after| {
        let (app, id) = (Arc::clone(&app), id.clone());
        async move { batch(&app, &id, Some(after)).await }
    }))
}

async fn batch(app: &App, id: &str, after: Option<u64>) -> Result<Batch<u64>, Problem> {
    let images = app.catalogue.results(id, after, RECORDS_BATCH).await?;
    let full = images.len() == RECORDS_BATCH as usize;
    let last = images
        .last()
        .and_then(|image| image.record.get("frame").and_then(Value::as_u64));
    Ok(Batch {
        bytes: lines::json_lines(images.into_iter().map(view))?,
        next: last.filter(|_| full),
    })
}
