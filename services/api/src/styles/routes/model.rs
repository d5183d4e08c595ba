//! `GET /v1/worker/styles` and `GET /v1/worker/styles/{name}`.

use std::sync::Arc;

use axum::extract::State;
use axum::response::IntoResponse;
use proto::message::Style;
use proto::wire::StylesResponse;

use crate::http::extract::{Path, ProtoBody};
use crate::http::problem::{Problem, found};
use crate::http::stored::octets;
use crate::styles::Styles;

/// The style models that jobs may name, for workers that do not know one of them.
pub(crate) async fn styles(State(styles): State<Arc<Styles>>) -> Result<ProtoBody<StylesResponse>, Problem> {
    let known = styles.known();
    let names = known.library.names();
    let style = |name: &str| {
        let model = known.library.get(name)?;
        Some(serde_json::to_string(&model.card).map(|card_json| Style {
            name: name.to_owned(),
            card_json,
        }))
    };
    let listed: Result<Vec<Style>, _> = names.into_iter().filter_map(style).collect();
    Ok(ProtoBody(
        listed.map_err(|error| Problem::internal(&error))?.into(),
    ))
}

/// The ONNX file of a style model.
pub(crate) async fn style(
    State(styles): State<Arc<Styles>>,
    Path(name): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let model = found(styles.known().library.shared(&name), "style", &name)?;
    Ok(octets(model.onnx.to_vec()))
}
