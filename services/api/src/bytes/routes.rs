use axum::response::IntoResponse;

use crate::bytes::Bytes;
use crate::http::stored::octets;
use crate::http::{Path, Problem, State, Topic, found};

/// Returns the bytes of an uploaded scene's file.
pub(crate) async fn blob(
    State(bytes): Topic<Bytes>,
    Path(digest): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let blob = bytes.store.get(&digest).await?;
    Ok(octets(found(blob, "stored bytes with the digest", &digest)?))
}
