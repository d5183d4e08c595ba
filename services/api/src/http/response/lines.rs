//! Line-by-line responses, fetched in batches as the client reads. Memory stays bounded, and a client that stops
//! reading stops the fetching.

use std::io;

use axum::body::{Body, Bytes};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use catalogue::CatalogueError;
use futures::stream::{self, StreamExt};
use serde::Serialize;

use crate::http::problem::Problem;

/// One JSON value per line.
pub(crate) const NDJSON: &str = "application/x-ndjson";

/// Some lines and the cursor of the next batch; `None` at the end.
pub(crate) struct Batch<C> {
    pub(crate) bytes: Vec<u8>,
    pub(crate) next: Option<C>,
}

/// Sends a first batch and the following ones. A later error truncates the response, which the client detects.
pub(crate) fn respond<C, F>(
    media_type: &'static str,
    first: Batch<C>,
    fetch: impl Fn(C) -> F + Send + 'static,
) -> Response
where
    C: Send + 'static,
    F: Future<Output = Result<Batch<C>, Problem>> + Send + 'static,
{
    let rest = stream::try_unfold(first.next, move |next| {
        let batch = next.map(&fetch);
        async move {
            let Some(batch) = batch else { return Ok(None) };
            let Batch { bytes, next } = batch.await.map_err(cut_short)?;
            Ok(Some((Bytes::from(bytes), next)))
        }
    });
    let all = stream::iter([Ok::<_, io::Error>(Bytes::from(first.bytes))]).chain(rest);
    ([(header::CONTENT_TYPE, media_type)], Body::from_stream(all)).into_response()
}

/// The rows of a job as lines of JSON, in frame order. `read` returns at most `most` rows after a frame.
pub(crate) async fn stream_frames<T, F>(
    most: u32,
    read: impl Fn(Option<u64>) -> F + Send + Sync + 'static,
    frame: fn(&T) -> Option<u64>,
) -> Result<Response, Problem>
where
    T: Serialize + Send + 'static,
    F: Future<Output = Result<Vec<T>, CatalogueError>> + Send + 'static,
{
    let first = to_batch(read(None).await?, most, frame)?;
    Ok(respond(NDJSON, first, move |after| {
        let rows = read(Some(after));
        async move { to_batch(rows.await?, most, frame) }
    }))
}

fn to_batch<T: Serialize>(
    rows: Vec<T>,
    most: u32,
    frame: fn(&T) -> Option<u64>,
) -> Result<Batch<u64>, Problem> {
    let has_more = rows.len() == most as usize;
    let next = rows.last().filter(|_| has_more).and_then(frame);
    let bytes = json_lines(rows)?;
    Ok(Batch { bytes, next })
}

/// Values as lines of JSON.
pub(crate) fn json_lines<T: Serialize>(values: impl IntoIterator<Item = T>) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    for value in values {
        serde_json::to_writer(&mut bytes, &value).map_err(|error| Problem::internal(&error))?;
        bytes.push(b'\n');
    }
    Ok(bytes)
}

/// The error that truncates a response.
pub(crate) fn cut_short(problem: Problem) -> io::Error {
    tracing::warn!(%problem, "a response was truncated");
    io::Error::other(problem.to_string())
}
