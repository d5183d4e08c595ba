//! `GET /v1/worker/styles` and `GET /v1/worker/styles/{name}`.

use axum::extract::State;
use axum::http::header;
use axum::response::IntoResponse;
use proto::message::Style;
use proto::wire::StylesResponse;

use crate::app::Shared;
use crate::http::extract::{Path, ProtoBody};
use crate::http::problem::Problem;

/// The style models that jobs may name, for workers that do not know one of them.
pub(crate) async fn styles(State(app): State<Shared>) -> Result<ProtoBody<StylesResponse>, Problem> {
    let known = app.styles.known();
    let names = known.library.names();
    let style = |name: &str| {
        let model = known.library.get(name)?;
        Some(serde_json::to_string(&model.card).map(|card_json| Style {
            name: name.to_owned(),
            card_json,
        }))
    };
    let styles: Result<Vec<Style>, _> = names.into_iter().filter_map(style).collect();
    Ok(ProtoBody(
        styles.map_err(|error| Problem::internal(&error))?.into(),
    ))
}

/// The ONNX file of a style model.
pub(crate) async fn style(
    State(app): State<Shared>,
    Path(name): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let model = app
        .styles
        .known()
        .library
        .shared(&name)
        .ok_or_else(|| Problem::not_found(format!("no style `{name}`")))?;
    Ok((
        [(header::CONTENT_TYPE, "application/octet-stream")],
        model.onnx.to_vec(),
    ))
}
