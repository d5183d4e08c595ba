//! Kinds of work: frames of one kind have similar costs relative to the typical ones.

use spec::{Fidelity, Frame, Scene};

use super::typical::runs;

/// Stages that distinguish kinds.
const STAGES: [&str; 9] = [
    "water",
    "turbidity",
    "lamps",
    "snow",
    "style",
    "haze",
    "flow",
    "disparity",
    "right",
];

/// Scene, fidelity, size and stages of a frame.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct WorkKind(String);

impl WorkKind {
    /// The kind of a frame. Sizes within a factor of four and lamps within a factor of two are one kind.
    pub(crate) fn new(frame: &Frame, pixels: f64) -> Self {
        let scene = match &frame.scene {
            Scene::Procedural { family, .. } => family.as_str(),
            _ => "picture",
        };
        let fidelity = match frame.fidelity {
            Fidelity::Picture => "picture",
            Fidelity::Reference => "reference",
            Fidelity::Tolerance(_) => "tolerance",
            Fidelity::Terms(_) => "terms",
            Fidelity::BudgetMs(_) => "budget",
        };
        let size = (pixels.max(1.0).log2() / 2.0) as u32;
        let lamps = frame.lamp_count().checked_ilog2();
        let mut kind = format!("{scene} {fidelity} {size} {lamps:?}");
        let steps = frame.enhance.iter().flat_map(|enhancement| &enhancement.steps);
        let stages = STAGES.into_iter().filter(|stage| runs(frame, stage));
        for name in stages.chain(steps.map(|step| step.name())) {
            kind.push(' ');
            kind.push_str(name);
        }
        Self(kind)
    }
}
