//! The effects of a frame, chosen before it is planned.

use spec::Fidelity;

use super::Slot;
use crate::context::FrameContext;
use crate::effects::{Effects, expect_cost};
use crate::error::RenderError;
use crate::planning::plan_frame;
use crate::preview::{ESTIMATED, Preview};
use crate::stage::camera::{self, Expected};
use crate::stopwatch::Stopwatch;

impl Slot {
    /// Leaves out the effects that do not change the picture of a frame, as far as a thinned picture shows. Frames of another
    /// fidelity than `picture` have all.
    pub(super) fn choose_effects(
        &mut self,
        context: &mut FrameContext<'_>,
        expected: Option<Expected>,
        watch: &mut Stopwatch,
    ) -> Result<(), RenderError> {
        let mut effects = match context.frame.fidelity {
            Fidelity::Reference | Fidelity::Terms(_) | Fidelity::Tolerance(_) => Effects::default(),
            Fidelity::Picture | Fidelity::BudgetMs(_) => {
                watch.time("plan", || self.estimate_effects(context, expected))?
            }
        };
        let Fidelity::BudgetMs(budget_ms) = context.frame.fidelity else {
            context.apply(effects, &mut self.resources, watch);
            return Ok(());
        };
        context.apply(effects.clone(), &mut self.resources, watch);
        let engine = &self.networks.engine;
        while plan_frame(context, expected, None, engine)?
            .cost_ms()
            .is_some_and(|cost| cost > budget_ms)
            && effects.drop_least()
        {
            context.apply(effects.clone(), &mut self.resources, watch);
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
        let Some(preview) = Preview::new(&thin, gain, 3.0 * camera::hidden_error(context.frame)) else {
            return Ok(effects);
        };
        for id in ESTIMATED {
            let change = preview.measure_change(id, expect_cost(id, context));
            if let Some(change) = change {
                effects.add(id, change);
            }
        }
        Ok(effects)
    }
}
