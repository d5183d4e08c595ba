use axum::response::IntoResponse;
use wire::messages::{Style, StylesResponse};

use crate::http::stored::octets;
use crate::http::{Path, Problem, Protobuf, State, Topic, found};
use crate::styles::Styles;

/// Lists the style models for workers that lack one of them.
pub(crate) async fn styles(State(styles): Topic<Styles>) -> Result<Protobuf<StylesResponse>, Problem> {
    let known = styles.known();
    let names = known.library.names();
    let styles = names
        .into_iter()
        .filter_map(|name: &str| {
            let model = known.library.get(name)?;
            let card = serde_json::to_string(&model.card).map_err(|error| Problem::internal(&error));
            Some(card.map(|card_json| Style {
                name: name.to_owned(),
                card_json,
            }))
        })
        .collect::<Result<_, _>>()?;
    Ok(Protobuf(StylesResponse { styles }))
}

/// Returns the ONNX file of a style model.
pub(crate) async fn style(
    State(styles): Topic<Styles>,
    Path(name): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let model = found(styles.known().library.shared(&name), "style", &name)?;
    Ok(octets(model.onnx.to_vec()))
}
