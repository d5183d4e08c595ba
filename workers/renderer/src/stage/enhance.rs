//! Enhancement of the 8-bit result.

use std::collections::BTreeMap;

use enhance::ibla::Form;
use enhance::{Enhanced, Method};
use imaging::{Raster, Rgb8};
use optics::plan::IblaForm;
use spec::{Frame, FrameRecord};

use super::Shot;
use crate::error::RenderError;

/// Results by method name.
pub(crate) type Enhancements = BTreeMap<String, Enhanced>;

/// The method that has faster forms, which is the exact one of them.
const IBLA: &str = Form::ALL[0].name();

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
        let method = Method::parse(planned(shot, name)).ok_or_else(|| RenderError::Unknown {
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

/// What the plan has to know of the forms of `ibla`, where the frame asks for that.
pub(crate) fn forms(frame: &Frame) -> Vec<IblaForm> {
    if !frame.enhance.iter().any(|name| name == IBLA) {
        return Vec::new();
    }
    let forms = Form::ALL.into_iter().map(|form| IblaForm {
        method: form.name(),
        distance: form.method().distance(),
    });
    forms.collect()
}

/// The method that runs under a name: of `ibla` the form of the plan.
fn planned<'a>(shot: &'a Shot<'_>, name: &'a str) -> &'a str {
    match &shot.plan.ibla {
        Some(stage) if name == IBLA => stage.form.method,
        _ => name,
    }
}
