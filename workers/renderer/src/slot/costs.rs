//! The time of planned stages on this machine, relative to the costs of plans, which are those of a reference machine.

use std::collections::BTreeMap;

use optics::plan::{Plan, StageId};

use crate::effects::ESTIMATED;

/// Factors of expected costs by timing, for the stages that every plan has and for the effects that a plan may leave out. They differ:
/// shadow rays through a range image are slower than those through solids, while arithmetic has the same speed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CostScale {
    pub(crate) base: BTreeMap<&'static str, f64>,
    pub(crate) effects: BTreeMap<&'static str, f64>,
}

/// The expected milliseconds of a stage on the reference machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StageCost {
    pub(crate) id: StageId,
    pub(crate) ms: f64,
}

impl CostScale {
    /// Expected milliseconds of some stages on this machine.
    pub(crate) fn expect_ms(&self, costs: &[StageCost]) -> f64 {
        costs.iter().map(|cost| cost.ms * self.factor(cost.id)).sum()
    }

    /// The factor of a stage; 1 if it is unknown.
    pub(crate) fn factor(&self, id: StageId) -> f64 {
        let factors = if is_effect(id) { &self.effects } else { &self.base };
        factors.get(timing(id)).copied().unwrap_or(1.0)
    }
}

/// The stages of a plan with a cost.
pub(crate) fn list_costs(plan: &Plan) -> Vec<StageCost> {
    let stages = plan.stages.iter();
    let costs = stages.filter_map(|stage| {
        Some(StageCost {
            id: stage.id,
            ms: stage.cost_ms.filter(|ms| *ms > 0.0)?,
        })
    });
    costs.collect()
}

/// Whether a stage is an effect that a plan may leave out.
pub(crate) fn is_effect(id: StageId) -> bool {
    ESTIMATED.contains(&id)
}

/// The timing of records that includes a stage.
pub(crate) fn timing(id: StageId) -> &'static str {
    match id {
        StageId::SceneLight
        | StageId::Surfaces
        | StageId::SunShadow
        | StageId::AmbientAccess
        | StageId::Caustics => "above",
        StageId::Lamps | StageId::LampShadows | StageId::Glow | StageId::GlowShadows => "lamps",
        StageId::Turbidity => "turbidity",
        StageId::Attenuation
        | StageId::Veil
        | StageId::VeilOcclusion
        | StageId::Occlusion
        | StageId::ForwardScatter(_)
        | StageId::Shafts => "water",
        StageId::Sediment | StageId::Snow => "snow",
        StageId::Movement | StageId::Geometry | StageId::Defocus | StageId::Vignette | StageId::Exposure => {
            "camera"
        }
        StageId::Sensor | StageId::Demosaic | StageId::WhiteBalance | StageId::Jpeg => "encode",
        StageId::Style => "style",
        StageId::Haze => "haze",
        StageId::Enhance | StageId::Ibla => "enhance",
        StageId::Truth => "truth",
    }
}
