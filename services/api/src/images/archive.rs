//! Artifacts of an image, and its record on request, as one tar, read as the client reads.

use std::io;
use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use catalogue::StoredArtifact;
use futures::stream::{self, StreamExt};
use tar::{EntryType, Header};

use super::Images;
use crate::http::lines::cut_short;
use crate::http::problem::Problem;
use crate::http::stored::GUARDED;

const BLOCK: u64 = 512;
/// A tar ends with two blocks of zeros.
const END: [u8; 2 * BLOCK as usize] = [0; 2 * BLOCK as usize];

/// Name of the record in the tar.
const RECORD: &str = "record.json";

/// Sends the requested record and artifacts. An error of the first part is a problem response; a later error
/// truncates the response, which the client detects.
pub(crate) async fn response(
    images: Arc<Images>,
    record: Option<Vec<u8>>,
    artifacts: Vec<StoredArtifact>,
) -> Result<Response, Problem> {
    let lengths = record.iter().map(|record| record.len() as u64);
    let lengths = lengths.chain(artifacts.iter().map(|artifact| artifact.entry.bytes));
    let blocks: u64 = lengths.map(|bytes| 1 + bytes.div_ceil(BLOCK)).sum();
    let length = blocks * BLOCK + END.len() as u64;
    let mut artifacts = artifacts.into_iter();
    let first = match record {
        Some(record) => member(RECORD, &record)?,
        None => match artifacts.next() {
            Some(artifact) => file(&images, artifact).await?,
            None => Bytes::new(),
        },
    };
    let rest = stream::iter(artifacts).then(move |artifact| {
        let images = Arc::clone(&images);
        async move { file(&images, artifact).await.map_err(cut_short) }
    });
    let all = stream::iter([Ok::<_, io::Error>(first)]);
    let all = all
        .chain(rest)
        .chain(stream::iter([Ok(Bytes::from_static(&END))]));
    let headers = [
        (header::CONTENT_TYPE, "application/x-tar".to_owned()),
        (header::CONTENT_LENGTH, length.to_string()),
    ];
    Ok((headers, GUARDED, Body::from_stream(all)).into_response())
}

/// An artifact as a member of the tar.
async fn file(images: &Images, artifact: StoredArtifact) -> Result<Bytes, Problem> {
    let entry = &artifact.entry;
    let name = format!("{}.{}", entry.kind, renderer::extension(&entry.media_type));
    let length = entry.bytes;
    let stored = images.stored(artifact).await?.bytes;
    if stored.len() as u64 != length {
        let what = format!("{name} has {} bytes but {length} in its record", stored.len());
        return Err(Problem::internal(&what));
    }
    member(&name, &stored)
}

/// A file with its header and padding.
fn member(name: &str, bytes: &[u8]) -> Result<Bytes, Problem> {
    let length = bytes.len() as u64;
    let mut header = Header::new_ustar();
    header.set_path(name).map_err(|error| Problem::internal(&error))?;
    header.set_entry_type(EntryType::Regular);
    header.set_mode(0o644);
    header.set_mtime(0);
    header.set_size(length);
    header.set_cksum();
    let padded = (BLOCK + length.next_multiple_of(BLOCK)) as usize;
    let mut file = Vec::with_capacity(padded);
    file.extend_from_slice(header.as_bytes());
    file.extend_from_slice(bytes);
    file.resize(padded, 0);
    Ok(file.into())
}
