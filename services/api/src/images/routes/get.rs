//! `GET /v1/images/{job}/{frame}`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use serde_json::Value;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::images::Images;

/// The record of an image: resolved parameters, optics, plan, metrics, artifacts, timings, provenance.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}", tag = "images",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    responses((status = 200, description = "The record.", body = Value)))]
pub(crate) async fn get(
    State(images): State<Arc<Images>>,
    Path((job, frame)): Path<(String, u64)>,
) -> Result<Json<Value>, Problem> {
    Ok(Json(images.get(&job, frame).await?))
}
