//! Style models that the service has and this worker does not.

use super::client::ClientError;

use super::Shared;

/// Fetches the models that are missing here.
pub(crate) fn learn(shared: &Shared) -> Result<(), ClientError> {
    let mut library = shared.engine.library();
    let mut learned = false;
    for style in shared.service.styles()? {
        if library.get(&style.name).is_some() {
            continue;
        }
        let onnx = shared.service.style(&style.name)?;
        match library
            .clone()
            .with_model(&style.name, onnx, Some(&style.card_json))
        {
            Ok(larger) => {
                tracing::info!(style = style.name, "a style was fetched from the service");
                library = larger;
                learned = true;
            }
            Err(error) => {
                tracing::warn!(style = style.name, %error, "a style of the service cannot be used here")
            }
        }
    }
    if learned {
        shared.engine.replace_library(library);
    }
    Ok(())
}
