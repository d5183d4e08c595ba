//! `GET /v1/images/{job}/{frame}/preview`.

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use imaging::codec;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::http::stored;
use crate::limits;

/// A thumbnail of the result: a PNG of at most 256 px a side.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}/preview", tag = "images",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    responses((status = 200, description = "The thumbnail.", content_type = "image/png"),
              (status = 304, description = "The copy at hand is right."),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn preview(
    State(app): State<Shared>,
    Path((job, frame)): Path<(String, u64)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let entry = app.catalogue.artifact(&job, frame, "rgb").await?;
    let entry =
        entry.ok_or_else(|| Problem::not_found(format!("no artifact `rgb` of image `{job}/{frame}`")))?;
    let tag = format!("{}-{}", entry.digest, limits::PREVIEW_PX);
    if stored::is_at_hand(&headers, &tag) {
        return Ok(stored::not_modified(&tag));
    }
    let bytes = crate::images::bytes(&app, &entry).await?;
    let thumbnail = app
        .compute
        .run(move || thumbnail(&bytes))
        .await?
        .map_err(|error| Problem::internal(&error))?;
    let png = [(header::CONTENT_TYPE, HeaderValue::from_static("image/png"))];
    Ok((stored::immutable(&tag), png, thumbnail).into_response())
}

fn thumbnail(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let picture = codec::decode_picture(bytes).map_err(|error| error.to_string())?;
    let small = codec::downscale(&picture.to_rgb8(), limits::PREVIEW_PX);
    codec::encode_png(&small.into()).map_err(|error| error.to_string())
}
