//! `GET /v1/worker/blobs/{digest}`.

use std::sync::Arc;

use axum::extract::State;
use axum::response::IntoResponse;

use crate::bytes::Bytes;
use crate::http::extract::Path;
use crate::http::problem::{Problem, found};
use crate::http::stored::octets;

/// The bytes of an uploaded scene's file.
pub(crate) async fn blob(
    State(bytes): State<Arc<Bytes>>,
    Path(digest): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let blob = bytes.store.get(&digest).await?;
    Ok(octets(found(blob, "stored bytes with the digest", &digest)?))
}
