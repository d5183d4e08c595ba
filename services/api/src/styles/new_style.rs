//! A network to be added as a style.

use style::{ModelCard, StyleModel, is_name};

use crate::http::problem::Problem;

/// Caveat on the card of every added style.
pub(super) const NO_PROMISE: &str = "added by a user; its stability over frames and sizes is not measured";

/// A network to be added as a style.
pub(crate) struct NewStyle {
    pub(crate) onnx: Vec<u8>,
    /// Its card; name, file and digest are already correct.
    pub(crate) card: ModelCard,
}

impl NewStyle {
    /// An unverified network with a name. The caller completes the card.
    pub(crate) fn new(name: &str, onnx: Vec<u8>) -> Result<Self, Problem> {
        if !is_name(name) {
            let message = format!("name is `{name}`; must have 1 to 64 characters of a-z, 0-9, _ and -");
            return Err(Problem::field("/name", message));
        }
        let StyleModel { onnx, mut card, .. } = StyleModel::without_card(name, onnx);
        card.caveats = vec![NO_PROMISE.to_owned()];
        Ok(Self {
            onnx: onnx.into_owned(),
            card,
        })
    }
}
