//! `GET /v1/images/{job}/{frame}`.

use axum::Json;
use axum::extract::State;
use serde_json::Value;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;

/// The record of an image: resolved parameters, optics, plan, metrics, artifacts, timings, provenance.
#[utoipa::path(get, path = "/v1/images/{job}/{frame}", tag = "images",
    params(("job" = String, Path, description = "`job_…`"), ("frame" = u64, Path, description = "From 0")),
    responses((status = 200, description = "The record.", body = Value),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn get(
    State(app): State<Shared>,
    Path((job, frame)): Path<(String, u64)>,
) -> Result<Json<Value>, Problem> {
    let image = app.catalogue.image(&job, frame).await?;
    let image = image.ok_or_else(|| Problem::not_found(format!("no image `{job}/{frame}`")))?;
    Ok(Json(crate::images::view(image)))
}
