//! Which styles there are.

use crate::check::{MessageError, id, length, text};
use crate::message::Style;
use crate::{limits, wire};

impl TryFrom<wire::Style> for Style {
    type Error = MessageError;

    fn try_from(wire: wire::Style) -> Result<Self, MessageError> {
        Ok(Self {
            name: id("name", wire.name)?,
            card_json: text("card_json", wire.card_json, limits::CARD_BYTES)?,
        })
    }
}

impl From<Style> for wire::Style {
    fn from(Style { name, card_json }: Style) -> Self {
        Self { name, card_json }
    }
}

impl TryFrom<wire::StylesResponse> for Vec<Style> {
    type Error = MessageError;

    fn try_from(wire: wire::StylesResponse) -> Result<Self, MessageError> {
        length("styles", wire.styles.len(), limits::STYLES, "styles")?;
        wire.styles.into_iter().map(Style::try_from).collect()
    }
}

impl From<Vec<Style>> for wire::StylesResponse {
    fn from(styles: Vec<Style>) -> Self {
        Self {
            styles: styles.into_iter().map(wire::Style::from).collect(),
        }
    }
}
