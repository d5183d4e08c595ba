//! The effects of a frame, chosen before it is planned.

use optics::layering::Layering;
use optics::plan::{StageId, occlusion_ns};
use spec::Fidelity;

use super::costs::{CostScale, list_costs};
use super::kept::KeptEffects;
use super::state::Slot;
use crate::context::FrameContext;
use crate::effects::{ESTIMATED, Effects};
use crate::error::RenderError;
use crate::planning::plan_frame;
use crate::preview::Preview;
use crate::stage::camera::{self, Expected};
use crate::stage::{daylight, lamps};
use crate::stopwatch::Stopwatch;

impl Slot {
    /// From now on a frame may have the effects of an earlier one, beginning with the next. All must be of one job and fidelity, and
    /// their plans depend on their order.
    pub(crate) fn keep_effects(&mut self) {
        self.kept_effects = Some(KeptEffects::default());
    }

    /// From now on effects are chosen for each frame.
    pub(crate) fn choose_each_time(&mut self) {
        self.kept_effects = None;
    }

    /// Sets the costs of this machine, which budgets are compared with.
    pub(crate) fn set_costs(&mut self, costs: CostScale) {
        self.costs = costs;
    }

    /// Leaves out the effects that do not visibly change a thinned picture of the frame, and further ones to meet a budget. Other
    /// fidelities than picture and budget run all effects.
    pub(super) fn choose_effects(
        &mut self,
        context: &mut FrameContext<'_>,
        expected: Option<Expected>,
        watch: &mut Stopwatch,
    ) -> Result<(), RenderError> {
        if let Some(effects) = self.kept_effects.as_mut().and_then(|kept| kept.reuse(context)) {
            context.apply(effects, &mut self.resources, watch);
            return Ok(());
        }
        let mut effects = match context.frame.fidelity {
            Fidelity::Reference | Fidelity::Terms(_) | Fidelity::Tolerance(_) => Effects::default(),
            Fidelity::Picture | Fidelity::BudgetMs(_) => {
                watch.time("plan", || self.estimate_effects(context, expected))?
            }
        };
        self.excluded.iter().for_each(|id| effects.exclude(*id));
        context.apply(effects.clone(), &mut self.resources, watch);
        if let Fidelity::BudgetMs(budget_ms) = context.frame.fidelity {
            let engine = &self.networks.engine;
            loop {
                let plan = plan_frame(context, expected, None, engine)?;
                let excess_ms = self.costs.expect_ms(&list_costs(&plan)) - budget_ms;
                if excess_ms <= 0.0 || !effects.economize(excess_ms) {
                    break;
                }
                context.apply(effects.clone(), &mut self.resources, watch);
            }
        }
        if let Some(kept) = &mut self.kept_effects {
            kept.keep(context, effects);
        }
        Ok(())
    }

    fn estimate_effects(
        &mut self,
        context: &FrameContext<'_>,
        expected: Option<Expected>,
    ) -> Result<Effects, RenderError> {
        let mut effects = Effects::default();
        let has_light = context.setting.lighting.is_some()
            || context
                .setting
                .water
                .as_ref()
                .is_some_and(|water| water.daylight().is_some());
        if !has_light {
            return Ok(effects);
        }
        let prepared = camera::thin_scene(context.prepared);
        let frame = camera::thin_frame(context.frame, prepared.scene.radiance.size());
        let unused = &mut Stopwatch::start();
        let thin = FrameContext::new(&frame, &prepared, 0.0, &mut self.thin.resources, unused)?;
        let gain = expected.map_or(1.0, |expected| expected.gain);
        let layering = context.find_layers();
        let layers = layering.as_ref().map_or(0, Layering::count);
        let noise = 3.0 * camera::hidden_error(context.frame);
        let Some(preview) = Preview::new(&thin, layering, gain, noise) else {
            return Ok(effects);
        };
        for id in ESTIMATED {
            let expected_ms = self.costs.factor(id) * expect_effect_ms(context, layers, id);
            let change = preview.measure_change(id, expected_ms);
            if let Some(change) = change {
                effects.add(id, change);
            }
        }
        Ok(effects)
    }
}

/// Expected milliseconds of one effect in a frame of this many layers.
fn expect_effect_ms(context: &FrameContext<'_>, layers: usize, id: StageId) -> f64 {
    let ns = match (id, &context.setting.lighting) {
        (StageId::Occlusion, _) => occlusion_ns(layers),
        (StageId::LampShadows, Some(lighting)) => lamps::shadow_ns(lighting),
        _ => daylight::effect_ns(context, id),
    };
    let (width, height) = context.setting.size;
    ns * (width * height) as f64 / 1e6
}

/// The warning of a frame whose cheapest plan exceeds its budget.
pub(super) fn find_overrun(context: &FrameContext<'_>, costs: &CostScale) -> Option<String> {
    let Fidelity::BudgetMs(budget_ms) = context.frame.fidelity else {
        return None;
    };
    let cost = costs.expect_ms(&list_costs(&context.plan));
    (cost > budget_ms).then(|| format!(
        "`fidelity.budget_ms` is {budget_ms}, but the cheapest plan is expected to take {cost:.0} ms; raise it or make the picture \
         smaller"
    ))
}
