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

/// The method with faster variants; its exact variant has the same name.
const IBLA: &str = IblaRefinement::ALL[0].name();

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
    let ibla = ibla.then(|| {
        let variants = IblaRefinement::ALL.map(|form| IblaVariant {
            method: form.name(),
            distance: form.method().distance(),
        });
        choose_ibla(&variants, tolerance)
    });
    std::iter::once(methods).chain(ibla).collect()
}

/// A variant of `ibla`, which is also a method.
#[derive(Clone, Copy)]
struct IblaVariant {
    method: &'static str,
    /// Measured distance of its results from the exact variant in linear light; 0 for the exact variant.
    distance: f64,
}

/// The fastest variant whose measured distance is within the tolerance; the exact variant without a tolerance. The distance is not a
/// bound: some frames exceed it.
fn choose_ibla(variants: &[IblaVariant], tolerance: Option<f64>) -> Stage {
    let (exact, faster) = (variants[0], &variants[1..]);
    let stage = |variant: IblaVariant, share: Option<f64>, note: String| Stage {
        share,
        bound: None,
        cost_ms: None,
        note: Some(note),
        ..Stage::new(StageId::Ibla, Variant::Fast(variant.method))
    };
    let Some(tolerance) = tolerance else {
        return stage(exact, None, "only a tolerance allows a faster variant".to_owned());
    };
    if let Some(near) = faster.iter().rfind(|variant| variant.distance <= tolerance) {
        let note = format!(
            "measured: {:.1e} from {} at most in 95 % of frames",
            near.distance, exact.method
        );
        return stage(*near, Some(tolerance), note);
    }
    let distances = faster
        .iter()
        .map(|variant| format!("{} {:.1e}", variant.method, variant.distance));
    let distances: Vec<String> = distances.collect();
    stage(
        exact,
        None,
        format!("beyond the tolerance: {}", distances.join(", ")),
    )
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

    const VARIANTS: [IblaVariant; 3] = [
        variant("exact", 0.0),
        variant("near", 0.015),
        variant("far", 0.13),
    ];

    const fn variant(method: &'static str, distance: f64) -> IblaVariant {
        IblaVariant { method, distance }
    }

    #[test]
    fn a_tolerance_takes_the_fastest_variant_within_it() {
        let near = "measured: 1.5e-2 from exact at most in 95 % of frames";
        let far = "measured: 1.3e-1 from exact at most in 95 % of frames";
        let none = "beyond the tolerance: near 1.5e-2, far 1.3e-1";
        for (tolerance, method, note) in [
            (3e-4, "exact", none),
            (0.0149, "exact", none),
            (0.015, "near", near),
            (0.129, "near", near),
            (0.13, "far", far),
            (1.0, "far", far),
        ] {
            let stage = choose_ibla(&VARIANTS, Some(tolerance));
            assert_eq!(stage.variant.name(), method, "{tolerance}");
            assert_eq!(stage.note.as_deref(), Some(note), "{tolerance}");
            assert_eq!(stage.share, (method != "exact").then_some(tolerance));
            assert_eq!(stage.bound, None);
        }
    }

    #[test]
    fn without_a_tolerance_the_exact_variant_runs() {
        let stage = choose_ibla(&VARIANTS, None);
        assert_eq!((stage.variant.name(), stage.share), ("exact", None));
    }
}
