//! The plan of a whole frame: that of the water, and that of the camera behind it.

use camera::Step;
use optics::plan::{Line, Plan};
use serde::Serialize;

/// How a frame would be rendered. Serialized it is its lines.
#[derive(Debug, Clone, PartialEq)]
pub struct FramePlan {
    /// Up to the style and behind it.
    pub water: Plan,
    /// The camera, line by line.
    camera: Vec<Line>,
    /// What a truth is expected to take; none where none is asked for.
    truth: Option<Line>,
}

impl FramePlan {
    pub(crate) fn new(water: &Plan, camera: Option<&camera::Plan>, truth: Option<Line>) -> Self {
        let line = |step: &Step| Line {
            stage: step.stage,
            variant: step.variant,
            terms: None,
            share: step.share,
            bound: step.bound,
            cost_ms: step.cost_ms,
            note: step.note.clone(),
            model_error: None,
        };
        Self {
            water: water.clone(),
            camera: camera
                .map(|plan| plan.steps.iter().map(line).collect())
                .unwrap_or_default(),
            truth,
        }
    }

    /// Line by line, the camera last, and behind it what only an artifact asks for.
    #[must_use]
    pub fn lines(&self) -> Vec<Line> {
        self.water
            .lines()
            .into_iter()
            .chain(self.camera.iter().cloned())
            .chain(self.truth.clone())
            .collect()
    }
}

impl Serialize for FramePlan {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.lines().serialize(serializer)
    }
}
