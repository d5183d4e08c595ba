//! Enhancement of the 8-bit result.

use std::collections::BTreeMap;

use enhance::{Enhanced, Method};
use imaging::{Raster, Rgb8};
use spec::FrameRecord;

use super::Shot;
use crate::error::RenderError;

/// Results by method name.
pub(crate) type Enhancements = BTreeMap<String, Enhanced>;

/// Runs every method of the frame on the result, independently of each other. Warnings of a method go into the record, such
/// as `ibla: lamp_as_background: …`.
pub(crate) fn run(
    shot: &Shot<'_>,
    rgb: &Rgb8,
    record: &mut FrameRecord,
) -> Result<Enhancements, RenderError> {
    let mut enhancements = Enhancements::new();
    if shot.frame.enhance.is_empty() {
        return Ok(enhancements);
    }
    let picture = Raster::from(rgb.clone());
    for name in &shot.frame.enhance {
        let method = Method::parse(name).ok_or_else(|| RenderError::Unknown {
            kind: "enhancement",
            name: name.clone(),
        })?;
        let enhanced = enhance::run(&method, &picture)?;
        let warnings = enhanced.warnings.iter();
        record
            .warnings
            .extend(warnings.map(|warning| format!("{name}: {warning}")));
        enhancements.insert(name.clone(), enhanced);
    }
    Ok(enhancements)
}
