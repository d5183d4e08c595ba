//! `GET /v1/images/{job}/{frame}/preview`.

use std::sync::Arc;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use imaging::codec;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::http::stored;
use crate::images::Images;
use crate::limits;

/// A thumbnail of the result: a PNG of at most 256 px a side.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}/preview", tag = "images",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    responses((status = 200, description = "The thumbnail.", content_type = "image/png"),
              (status = 304, description = "The copy at hand is right.")))]
pub(crate) async fn preview(
    State(images): State<Arc<Images>>,
    Path((job, frame)): Path<(String, u64)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let entry = images.artifact(&job, frame, "rgb").await?;
    let tag = format!("{}-{}", entry.digest, limits::PREVIEW_PX);
    if stored::is_at_hand(&headers, &tag) {
        return Ok(stored::not_modified(&tag));
    }
    let bytes = images.stored(entry).await?.bytes;
    let thumbnail = images.processes.compute.run(move || thumbnail(&bytes)).await?;
    let thumbnail = thumbnail.map_err(|error| Problem::internal(&error))?;
    let png = [(header::CONTENT_TYPE, HeaderValue::from_static("image/png"))];
    Ok((stored::immutable(&tag), png, thumbnail).into_response())
}

fn thumbnail(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let picture = codec::decode_picture(bytes).map_err(|error| error.to_string())?;
    let small = codec::downscale(&picture.to_rgb8(), limits::PREVIEW_PX);
    codec::encode_png(&small.into()).map_err(|error| error.to_string())
}
