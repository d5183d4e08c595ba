//! The inputs of every stage's plan.

use optics::lamp::{AirlightBounds, SurfaceBounds};
use optics::plan::{Budget, ErrorBound, SceneBounds, Variant, brightest_behind};
use spec::Fidelity;

use crate::context::FrameContext;
use crate::daylight_bounds::TileDaylight;

/// Inputs for assessing the stages.
pub(crate) struct Assessment<'a> {
    pub(crate) context: &'a FrameContext<'a>,
    /// The scene in the brightest possible light.
    pub(crate) bounds: SceneBounds,
    /// Daylight on the surfaces of each tile of the view; `None` if it reaches none.
    pub(crate) daylight: Option<Vec<TileDaylight>>,
    /// Light of lamps on surfaces; `None` without lamps.
    pub(crate) surfaces: Option<SurfaceBounds>,
    /// Airlight of lamps; `None` without lamps.
    pub(crate) airlight: Option<AirlightBounds>,
    /// The tolerated error of the exposed light; `None` for a fixed number of kernels and for the reference.
    pub(crate) tolerance: Option<ErrorBound>,
    pub(crate) budget: Budget,
}

impl Assessment<'_> {
    /// The variant of a stage: the reference for frames of that fidelity.
    pub(crate) fn variant(&self, fast: &'static str) -> Variant {
        if self.is_reference() {
            Variant::Reference
        } else {
            Variant::Fast(fast)
        }
    }

    pub(crate) fn is_reference(&self) -> bool {
        self.context.frame.fidelity == Fidelity::Reference
    }

    /// Number of pixels of the source picture.
    pub(crate) fn pixels(&self) -> usize {
        self.bounds.pixels
    }

    /// Bound on the light behind particles, with airlight up to this.
    pub(crate) fn brightest_behind(&self, airlight: f64) -> f64 {
        brightest_behind(&self.bounds, self.context.setting.around.as_ref(), airlight)
    }

    /// Bound on the airlight of lamps.
    pub(crate) fn airlight_peak(&self) -> f64 {
        self.airlight.as_ref().map_or(0.0, AirlightBounds::brightest)
    }
}
