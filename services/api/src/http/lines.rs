//! Answers of many lines that are fetched batch by batch while the client reads: memory stays small however many there
//! are, and a client that stops reading stops the fetching.

use std::io;

use axum::body::{Body, Bytes};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use futures::stream::{self, StreamExt};
use serde::Serialize;

use crate::http::problem::Problem;

/// One JSON value a line.
pub(crate) const NDJSON: &str = "application/x-ndjson";

/// Some lines, and where the next ones begin; none: there are no more.
pub(crate) struct Batch<C> {
    pub(crate) bytes: Vec<u8>,
    pub(crate) next: Option<C>,
}

/// Answers a first batch and then the following ones. A fault in between ends the answer short of its end, so that
/// the client notices.
pub(crate) fn answer<C, F>(
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

/// Values as lines of JSON.
pub(crate) fn json_lines<T: Serialize>(values: impl IntoIterator<Item = T>) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    for value in values {
        serde_json::to_writer(&mut bytes, &value).map_err(|error| Problem::internal(&error))?;
        bytes.push(b'\n');
    }
    Ok(bytes)
}

fn cut_short(problem: Problem) -> io::Error {
    tracing::warn!(%problem, "an answer of many lines was cut short");
    io::Error::other(problem.to_string())
}
