//! Enhancement of the 8-bit result.

use enhance::{Enhanced, Method};
use imaging::{Raster, Rgb8};
use spec::Frame;

use crate::error::RenderError;

/// What the methods say about this picture: `ibla: lamp_as_background: …`.
pub(crate) fn warnings(enhanced: &[(String, Enhanced)]) -> impl Iterator<Item = String> + '_ {
    enhanced.iter().flat_map(|(name, enhanced)| {
        let warnings = enhanced.warnings.iter();
        warnings.map(move |warning| format!("{name}: {warning}"))
    })
}

/// Runs every method of the frame on the result, each on its own.
pub(crate) fn run(frame: &Frame, rgb: &Rgb8) -> Result<Vec<(String, Enhanced)>, RenderError> {
    if frame.enhance.is_empty() {
        return Ok(Vec::new());
    }
    let picture = Raster::from(rgb.clone());
    let one = |name: &String| {
        let method = Method::parse(name).ok_or_else(|| RenderError::Unknown {
            kind: "enhancement",
            name: name.clone(),
        })?;
        Ok((name.clone(), enhance::run(&method, &picture)?))
    };
    frame.enhance.iter().map(one).collect()
}
