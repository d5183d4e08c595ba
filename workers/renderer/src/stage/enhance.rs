//! Enhancement of the 8-bit result.

use std::borrow::Cow;
use std::collections::BTreeMap;

use enhance::{IBLA_GUIDED_DISTANCE, Outcome};
use imaging::{Raster, Rgb8};
use optics::plan::{Stage, StageId, Variant};
use spec::{ArtifactKind, Enhancement, Frame, FrameRecord, IblaRefinement, Step};

use crate::context::FrameContext;
use crate::error::RenderError;
use crate::stage::networks::PictureNetworks;

/// Results by name.
pub(crate) type Enhancements = BTreeMap<String, Outcome>;

/// The refinements of IBLA in plans.
const MATTING: &str = "matting";
const GUIDED: &str = "guided";

/// The methods of a frame, and the refinement of IBLA if the planner chooses it.
pub(crate) fn assess(frame: &Frame, tolerance: Option<f64>) -> Vec<Stage> {
    if frame.enhance.is_empty() {
        return vec![Stage::skipped(StageId::Enhance)];
    }
    let methods = Stage {
        bound: None,
        cost_ms: None,
        ..Stage::new(StageId::Enhance, Variant::Fast("methods"))
    };
    let steps = frame.enhance.iter().flat_map(|enhancement| &enhancement.steps);
    let is_open = steps.into_iter().any(leaves_refinement);
    let ibla = is_open.then(|| choose_ibla(tolerance));
    std::iter::once(methods).chain(ibla).collect()
}

/// Whether the planner chooses the refinement of a step.
fn leaves_refinement(step: &Step) -> bool {
    matches!(step, Step::Ibla(ibla) if ibla.refine == IblaRefinement::Auto)
}

/// The fast variant if its measured distance is within the tolerance; else the exact one. The distance is not a bound: some frames
/// exceed it.
fn choose_ibla(tolerance: Option<f64>) -> Stage {
    let distance = IBLA_GUIDED_DISTANCE;
    let share = tolerance.filter(|&tolerance| distance <= tolerance);
    let (variant, note) = match (share, tolerance) {
        (Some(_), _) => (
            GUIDED,
            format!("measured: {distance:.1e} from {MATTING} at most in 95 % of frames"),
        ),
        (None, Some(_)) => (MATTING, format!("beyond the tolerance: {GUIDED} {distance:.1e}")),
        (None, None) => (MATTING, "only a tolerance allows a faster variant".to_owned()),
    };
    Stage {
        share,
        bound: None,
        cost_ms: None,
        note: Some(note),
        ..Stage::new(StageId::Ibla, Variant::Fast(variant))
    }
}

/// Runs every enhancement of the frame on the result, independently of each other. Adds their warnings to the record, such
/// as `ibla: lamp_as_background: …`.
pub(crate) fn run(
    context: &FrameContext<'_>,
    rgb: &Rgb8,
    networks: &mut PictureNetworks,
    record: &mut FrameRecord,
) -> Result<Enhancements, RenderError> {
    let mut enhancements = Enhancements::new();
    if context.frame.enhance.is_empty() {
        return Ok(enhancements);
    }
    let picture = Raster::from(rgb.clone());
    for enhancement in &context.frame.enhance {
        let name = &enhancement.name;
        let wanted = list_wanted(&context.frame.artifacts, name);
        let outcome = networks.enhance(&complete(context, enhancement), &picture, &wanted)?;
        let warnings = outcome.warnings.iter();
        record
            .warnings
            .extend(warnings.map(|warning| format!("{name}: {warning}")));
        enhancements.insert(name.clone(), outcome);
    }
    Ok(enhancements)
}

/// The requested intermediate results of an enhancement.
fn list_wanted<'a>(artifacts: &'a [ArtifactKind], name: &str) -> Vec<&'a str> {
    let own = artifacts.iter().filter_map(|kind| match kind.enhancement() {
        Some((of, step)) if of == name => step,
        _ => None,
    });
    own.collect()
}

/// The enhancement with the planner's choices.
pub(crate) fn complete<'a>(context: &FrameContext<'_>, enhancement: &'a Enhancement) -> Cow<'a, Enhancement> {
    let planned = context.plan.stage(StageId::Ibla);
    if planned.is_none_or(|stage| stage.variant.name() == MATTING) {
        return Cow::Borrowed(enhancement);
    }
    let mut complete = enhancement.clone();
    for step in &mut complete.steps {
        if let Step::Ibla(ibla) = step
            && ibla.refine == IblaRefinement::Auto
        {
            ibla.refine = IblaRefinement::Guided;
        }
    }
    Cow::Owned(complete)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_takes_the_fastest_variant_within_it() {
        let fast = "measured: 1.7e-1 from matting at most in 95 % of frames";
        let exact = "beyond the tolerance: guided 1.7e-1";
        for (tolerance, method, note) in [
            (3e-4, "matting", exact),
            (0.169, "matting", exact),
            (0.17, "guided", fast),
            (1.0, "guided", fast),
        ] {
            let stage = choose_ibla(Some(tolerance));
            assert_eq!(stage.variant.name(), method, "{tolerance}");
            assert_eq!(stage.note.as_deref(), Some(note), "{tolerance}");
            assert_eq!(stage.share, (method != "matting").then_some(tolerance));
            assert_eq!(stage.bound, None);
        }
    }

    #[test]
    fn without_a_tolerance_the_exact_variant_runs() {
        let stage = choose_ibla(None);
        assert_eq!((stage.variant.name(), stage.share), ("matting", None));
    }
}
