//! Enhancement of the 8-bit result.

use std::collections::BTreeMap;

use enhance::ibla::IblaRefinement;
use enhance::{Enhanced, Method};
use imaging::{Raster, Rgb8};
use optics::plan::{Stage, StageId, Variant};
use spec::{Frame, FrameRecord};

use crate::context::FrameContext;
use crate::error::RenderError;

/// Results by method name.
pub(crate) type Enhancements = BTreeMap<String, Enhanced>;

/// The method with a faster variant; its exact variant has the same name.
const IBLA: &str = IblaRefinement::Matting.name();

/// The methods of a frame, and the variant of `ibla`.
pub(crate) fn assess(frame: &Frame, tolerance: Option<f64>) -> Vec<Stage> {
    if frame.enhance.is_empty() {
        return vec![Stage::skipped(StageId::Enhance)];
    }
    let methods = Stage {
        bound: None,
        cost_ms: None,
        ..Stage::new(StageId::Enhance, Variant::Fast("methods"))
    };
    let ibla = frame.enhance.iter().any(|name| name == IBLA);
    let ibla = ibla.then(|| choose_ibla(tolerance));
    std::iter::once(methods).chain(ibla).collect()
}

/// The fast variant if its measured distance is within the tolerance; else the exact one. The distance is not a bound: some frames
/// exceed it.
fn choose_ibla(tolerance: Option<f64>) -> Stage {
    let fast = IblaRefinement::Guided;
    let (name, distance) = (fast.name(), fast.method().distance());
    let share = tolerance.filter(|&tolerance| distance <= tolerance);
    let (variant, note) = match (share, tolerance) {
        (Some(_), _) => (
            name,
            format!("measured: {distance:.1e} from {IBLA} at most in 95 % of frames"),
        ),
        (None, Some(_)) => (IBLA, format!("beyond the tolerance: {name} {distance:.1e}")),
        (None, None) => (IBLA, "only a tolerance allows a faster variant".to_owned()),
    };
    Stage {
        share,
        bound: None,
        cost_ms: None,
        note: Some(note),
        ..Stage::new(StageId::Ibla, Variant::Fast(variant))
    }
}

/// Runs every method of the frame on the result, independently of each other. Adds their warnings to the record, such as
/// `ibla: lamp_as_background: …`.
pub(crate) fn run(
    context: &FrameContext<'_>,
    rgb: &Rgb8,
    record: &mut FrameRecord,
) -> Result<Enhancements, RenderError> {
    let mut enhancements = Enhancements::new();
    if context.frame.enhance.is_empty() {
        return Ok(enhancements);
    }
    let picture = Raster::from(rgb.clone());
    for name in &context.frame.enhance {
        let method = Method::parse(planned_method(context, name)).ok_or_else(|| RenderError::Unknown {
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

/// The method to run for a name: for `ibla`, the planned variant.
fn planned_method<'a>(context: &'a FrameContext<'_>, name: &'a str) -> &'a str {
    match context.plan.stage(StageId::Ibla) {
        Some(stage) if name == IBLA => stage.variant.name(),
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_takes_the_fastest_variant_within_it() {
        let fast = "measured: 1.7e-1 from ibla at most in 95 % of frames";
        let exact = "beyond the tolerance: ibla_guided 1.7e-1";
        for (tolerance, method, note) in [
            (3e-4, "ibla", exact),
            (0.169, "ibla", exact),
            (0.17, "ibla_guided", fast),
            (1.0, "ibla_guided", fast),
        ] {
            let stage = choose_ibla(Some(tolerance));
            assert_eq!(stage.variant.name(), method, "{tolerance}");
            assert_eq!(stage.note.as_deref(), Some(note), "{tolerance}");
            assert_eq!(stage.share, (method != "ibla").then_some(tolerance));
            assert_eq!(stage.bound, None);
        }
    }

    #[test]
    fn without_a_tolerance_the_exact_variant_runs() {
        let stage = choose_ibla(None);
        assert_eq!((stage.variant.name(), stage.share), ("ibla", None));
    }
}
