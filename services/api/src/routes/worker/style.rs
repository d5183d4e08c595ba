//! `GET /v1/worker/styles/{name}`.

use axum::extract::State;
use axum::http::header;
use axum::response::IntoResponse;

use crate::extract::Path;
use crate::problem::Problem;
use crate::state::Shared;

/// The ONNX file of a style model, for workers that do not have it.
pub(crate) async fn style(
    State(app): State<Shared>,
    Path(name): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let model = app
        .library
        .get(&name)
        .ok_or_else(|| Problem::not_found(format!("no style `{name}`")))?;
    Ok((
        [(header::CONTENT_TYPE, "application/octet-stream")],
        model.onnx.to_vec(),
    ))
}
