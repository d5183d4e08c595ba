//! `GET /v1/images/{job}/{frame}/artifacts/{kind}`.

use std::sync::Arc;

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::http::stored;
use crate::images::Images;

/// The bytes of an artifact.
///
/// The entity tag is the SHA-256 of the bytes, so a copy never goes stale. Single ranges are answered.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}/artifacts/{kind}", tag = "images",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0"),
           ("kind" = String, Path, description = "Such as `rgb`, `range`, `enhanced.hscm`"),
           ("If-None-Match" = Option<String>, Header, description = "Entity tags of copies at hand"),
           ("Range" = Option<String>, Header, description = "One range of bytes")),
    responses((status = 200, description = "The bytes, verified against their digest.", content_type = "image/png"),
              (status = 206, description = "A range of the bytes.", content_type = "image/png"),
              (status = 304, description = "The copy at hand is right."),
              (status = 416, response = crate::openapi::Problem)))]
pub(crate) async fn artifact(
    State(images): State<Arc<Images>>,
    Path((job, frame, kind)): Path<(String, u64, String)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let entry = images.artifact(&job, frame, &kind).await?;
    if stored::is_at_hand(&headers, &entry.digest) {
        return Ok(stored::not_modified(&entry.digest));
    }
    images.stored(entry).await?.response(&headers)
}
