//! `GET /v1/worker/blobs/{digest}`.

use axum::extract::State;
use axum::http::header;
use axum::response::IntoResponse;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;

/// The bytes of an uploaded scene's file.
pub(crate) async fn blob(
    State(app): State<Shared>,
    Path(digest): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let bytes = app.store.get(&digest).await?;
    let bytes =
        bytes.ok_or_else(|| Problem::not_found(format!("no stored bytes with the digest `{digest}`")))?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes))
}
