//! Line-by-line responses, fetched in batches as the client reads. Memory stays bounded, and a client that stops
//! reading stops the fetching.

use std::collections::BTreeSet;
use std::io;
use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::http::{HeaderName, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use catalogue::CatalogueError;
use futures::stream::{self, StreamExt};
use serde::Serialize;

use crate::http::problem::{Problem, Slug};

/// One JSON value per line.
pub(crate) const NDJSON: &str = "application/x-ndjson";

/// The header that names the damaged rows that a response leaves out.
const DAMAGED: HeaderName = HeaderName::from_static("fathom-damaged");
/// Most names in the header.
const MOST_NAMES: usize = 20;

/// Some lines and the cursor of the next batch; `None` at the end.
pub(crate) struct Batch<C> {
    pub(crate) bytes: Vec<u8>,
    pub(crate) next: Option<C>,
    /// Rows left out of the lines.
    pub(crate) damaged: Vec<String>,
}

/// Sends a first batch and the following ones. A later error truncates the response, which the client detects, and so
/// does a damaged row that is not among the `known` ones: the header that names damaged rows is sent before it.
pub(crate) fn respond<C, F>(
    media_type: &'static str,
    first: Batch<C>,
    known: Vec<String>,
    fetch: impl Fn(C) -> F + Send + 'static,
) -> Response
where
    C: Send + 'static,
    F: Future<Output = Result<Batch<C>, Problem>> + Send + 'static,
{
    let named: Arc<BTreeSet<String>> = Arc::new(known.into_iter().chain(first.damaged).collect());
    let names = damaged_header(&named);
    let rest = stream::try_unfold(first.next, move |next| {
        let (batch, named) = (next.map(&fetch), Arc::clone(&named));
        async move {
            let Some(batch) = batch else { return Ok(None) };
            let Batch { bytes, next, damaged } = batch.await.map_err(cut_short)?;
            if let Some(what) = damaged.into_iter().find(|what| !named.contains(what)) {
                let detail = format!("{what} is damaged; a repeated request leaves it out");
                return Err(cut_short(Problem::new(Slug::CorruptArtifact, detail)));
            }
            Ok(Some((Bytes::from(bytes), next)))
        }
    });
    let all = stream::iter([Ok::<_, io::Error>(Bytes::from(first.bytes))]).chain(rest);
    let mut response = ([(header::CONTENT_TYPE, media_type)], Body::from_stream(all)).into_response();
    response.headers_mut().extend(names.map(|names| (DAMAGED, names)));
    response
}

/// The names, separated by semicolons.
fn damaged_header(named: &BTreeSet<String>) -> Option<HeaderValue> {
    let mut names: Vec<String> = named
        .iter()
        .take(MOST_NAMES)
        .map(|name| name.replace(|c: char| !matches!(c, ' '..='~') || c == ';', "?"))
        .collect();
    if named.len() > MOST_NAMES {
        names.push(format!("and {} more", named.len() - MOST_NAMES));
    }
    HeaderValue::try_from(names.join("; "))
        .ok()
        .filter(|_| !named.is_empty())
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
    Ok(respond(NDJSON, first, Vec::new(), move |after| {
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
    Ok(Batch {
        bytes: json_lines(rows)?,
        next,
        damaged: Vec::new(),
    })
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
