//! Downloads style models of the service that this worker lacks.

use crate::worker::client::Outcome;
use crate::worker::shared::Shared;

/// Fetches the missing models.
pub(crate) fn learn(shared: &Shared) -> Outcome<()> {
    let mut library = shared.engine.library();
    for style in shared.client.styles()? {
        let name = &style.name;
        if library.get(name).is_some() {
            continue;
        }
        let onnx = shared.client.style(name)?;
        match library.clone().with_model(name, onnx, Some(&style.card_json)) {
            Ok(larger) => {
                tracing::info!(style = name, "a style was fetched from the service");
                library = larger;
            }
            Err(error) => tracing::warn!(style = name, %error, "a style of the service cannot be used here"),
        }
    }
    shared.engine.replace_library(library);
    Ok(())
}
