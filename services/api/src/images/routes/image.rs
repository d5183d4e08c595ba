use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use imaging::codec;
use serde::Deserialize;
use serde_json::Value;
use utoipa::IntoParams;

use crate::http::{Json, Path, Problem, Query, State, Topic, bounds, stored};
use crate::images::{Images, archive};
use crate::limits;
use crate::openapi::{Bytes, ImageRecord};

/// Get the record of an image: resolved parameters, optics, plan, metrics, artifacts, timings, provenance.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}", tag = "images", operation_id = "get_image",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    responses((status = 200, description = "The record.", body = ImageRecord)))]
pub(crate) async fn get(
    State(images): Topic<Images>,
    Path((job, frame)): Path<(String, u64)>,
) -> Result<Json<Value>, Problem> {
    Ok(Json(images.get(&job, frame).await?))
}

/// Get the bytes of an artifact.
///
/// The entity tag is the SHA-256 of the bytes, so copies never become stale. Single ranges are supported.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}/artifacts/{kind}", tag = "images", operation_id = "get_artifact",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0"),
           ("kind" = spec::ArtifactKind, Path, description = "Such as `rgb`, `range`, `enhanced.hscm`"),
           ("If-None-Match" = Option<String>, Header, description = "Entity tags of the client's copies"),
           ("Range" = Option<String>, Header, description = "One range of bytes")),
    responses((status = 200, description = "The bytes, verified against their digest. NPY is `application/x-npy`, JSON `application/json`.",
               content((Bytes = "application/*"), (Bytes = "image/jpeg"), (Bytes = "image/png"), (Bytes = "image/webp"))),
              (status = 206, description = "A range of the bytes.",
               content((Bytes = "application/*"), (Bytes = "image/jpeg"), (Bytes = "image/png"), (Bytes = "image/webp"))),
              (status = 304, description = "The client's copy is current."),
              (status = 416, response = crate::openapi::Problem)))]
pub(crate) async fn artifact(
    State(images): Topic<Images>,
    Path((job, frame, kind)): Path<(String, u64, String)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let artifact = images.artifact(&job, frame, &kind).await?;
    let digest = &artifact.entry.digest;
    if stored::has_current_copy(&headers, digest) {
        return Ok(stored::not_modified(digest));
    }
    images.stored(artifact).await?.response(&headers)
}

/// Selection of artifacts.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Artifact kinds, separated by commas; absent: all.
    #[param(example = "rgb,range")]
    kinds: Option<String>,
    /// Whether to include the record of the image as the first file, `record.json`.
    #[serde(default)]
    #[param(default = false)]
    record: bool,
}

/// Get several artifacts of an image as one tar.
///
/// Its files are named `KIND.EXTENSION`, in the order of `kinds`, after the record if requested. The length is known
/// in advance. Bytes are verified against their digests while they are sent; a mismatch truncates the response.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}/artifacts", tag = "images",
    operation_id = "get_artifacts",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0"), Parameters),
    responses((status = 200, description = "The files.", content_type = "application/x-tar", body = Vec<u8>)))]
pub(crate) async fn artifacts(
    State(images): Topic<Images>,
    Path((job, frame)): Path<(String, u64)>,
    Query(query): Query<Parameters>,
) -> Result<Response, Problem> {
    let mut artifacts = images.artifacts(&job, frame).await?;
    if let Some(kinds) = &query.kinds {
        let known: Vec<_> = artifacts.iter().map(|found| found.entry.kind.as_str()).collect();
        let known = known.join(", ");
        let named = bounds::split_names(kinds).into_iter().map(|kind| {
            let artifact = artifacts.iter().find(|found| found.entry.kind == kind).cloned();
            artifact.ok_or_else(|| {
                Problem::not_found(format!(
                    "no artifact `{kind}` of image `{job}/{frame}`; it has {known}"
                ))
            })
        });
        artifacts = named.collect::<Result<_, _>>()?;
    }
    let record = match query.record {
        true => Some(images.get(&job, frame).await?.to_string().into_bytes()),
        false => None,
    };
    archive::response(images, record, artifacts).await
}

/// Get a thumbnail of the result: a PNG of at most 256 px a side.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}/preview", tag = "images", operation_id = "get_preview",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    responses((status = 200, description = "The thumbnail.", content((Bytes = "image/png"))),
              (status = 304, description = "The client's copy is current.")))]
pub(crate) async fn preview(
    State(images): Topic<Images>,
    Path((job, frame)): Path<(String, u64)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let artifact = images.artifact(&job, frame, "rgb").await?;
    let tag = format!("{}-{}", artifact.entry.digest, limits::PREVIEW_PX);
    if stored::has_current_copy(&headers, &tag) {
        return Ok(stored::not_modified(&tag));
    }
    let bytes = images.stored(artifact).await?.bytes;
    let thumbnail = images.processes.compute.run(move || thumbnail(&bytes)).await?;
    let thumbnail = thumbnail.map_err(|error| Problem::internal(&error))?;
    let png = [(header::CONTENT_TYPE, HeaderValue::from_static("image/png"))];
    Ok((stored::immutable(&tag), png, stored::GUARDED, thumbnail).into_response())
}

fn thumbnail(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let picture = codec::decode_picture(bytes).map_err(|error| error.to_string())?;
    let small = codec::downscale(&picture.to_rgb8(), limits::PREVIEW_PX);
    codec::encode_png(&small.into()).map_err(|error| error.to_string())
}
