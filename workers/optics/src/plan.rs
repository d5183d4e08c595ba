//! How a frame is rendered within its tolerance: the list of its stages, each with the variant that runs, its share of the
//! tolerance, its error bound and its expected cost.
//!
//! A plan is made before any light is computed, from cheap bounds of the scene, and can be printed, compared and stored. The
//! tolerance is the largest error of the exposed light, from black to white. [`Plan::promise`] composes the bounds of the stages
//! through their gains: `error = error * gain + bound`. A stage is skipped only if its whole effect stays within its share;
//! otherwise the cheapest variant is chosen whose bound does. A style network has no known gain, so the promise ends at its
//! input.

mod bins;
mod bounds;
mod casting;
mod levels;
mod model;
mod promise;
mod scattering;
mod shadows;
mod shares;
mod stage;
mod terms;
mod veil;
mod water;

pub use crate::error_bound::{ErrorBound, Gain};
pub use bins::{RangeBin, TileGains};
pub use bounds::SceneBounds;
pub use casting::Casting;
pub use levels::{brightest_behind, display_tolerance, frame_tolerance};
pub use model::{Conditions, LightError, PartErrors};
pub use shadows::{Shadows, Use};
pub use shares::{Budget, compose, compose_gain};
pub use stage::{ModelError, Stage, StageId, Variant};
pub use terms::MOST_TERMS;
pub(crate) use veil::BY_DIRECTION;
pub use water::{assess_water, occlusion_ns, water_gain};

use serde::Serialize;
use spec::Fidelity;

use crate::water::Water;
use scattering::{gates, layered, passages, scatter};

/// The plan of a frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    /// The tolerated error of the exposed light; `None` for a fixed number of kernels and for the reference.
    pub tolerance: Option<ErrorBound>,
    /// The stages in the order of light.
    pub stages: Vec<Stage>,
}

impl Plan {
    /// The plan of water alone, around a scene without lamps, snow, camera, style or haze.
    #[must_use]
    pub fn for_water(bounds: &SceneBounds, water: &Water, fidelity: Fidelity) -> Self {
        let tolerance = levels::tolerance(bounds, water, fidelity).map(ErrorBound::absolute);
        let share = Budget::new(tolerance, &[]).water(std::iter::empty(), Gain::ONE);
        let conditions = Conditions {
            water,
            lighting: None,
            patches: None,
            bounds,
        };
        let mut stages = assess_water(bounds, water, fidelity, share);
        for stage in &mut stages {
            stage.model_error = ModelError::measured(stage.id, &conditions);
        }
        Self { tolerance, stages }
    }

    /// A stage of it.
    #[must_use]
    pub fn stage(&self, id: StageId) -> Option<&Stage> {
        self.stages.iter().find(|stage| stage.id == id)
    }

    /// The variant of a stage that runs; [`Variant::Skip`] for stages that are not in the plan.
    #[must_use]
    pub fn variant(&self, id: StageId) -> &Variant {
        self.stage(id).map_or(&Variant::Skip, |stage| &stage.variant)
    }

    /// The same plan with another variant of a stage.
    #[must_use]
    pub fn with_variant(mut self, id: StageId, variant: Variant) -> Self {
        self.stages.retain(|stage| stage.id != id);
        self.stages.push(Stage::new(id, variant));
        self.stages.sort_by_key(|stage| stage.id);
        self
    }

    /// The largest error of each channel of the exposed light, composed through the gains.
    #[must_use]
    pub fn errors(&self) -> [ErrorBound; 3] {
        compose(self.stages.iter().filter(|stage| stage.id.is_promised()))
    }

    /// The greater of each part of the errors of all channels.
    #[must_use]
    pub fn error(&self) -> ErrorBound {
        self.errors()
            .into_iter()
            .fold(ErrorBound::EXACT, ErrorBound::greater)
    }

    /// Expected milliseconds of all stages; `None` if one has no figure.
    #[must_use]
    pub fn cost_ms(&self) -> Option<f64> {
        self.stages.iter().map(|stage| stage.cost_ms).sum()
    }
}

impl Serialize for Plan {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.stages.serialize(serializer)
    }
}

#[cfg(test)]
mod tests;
