//! The choices of a plan, to render a frame of another size with them.

use optics::plan::{Plan, StageId};
use renderer::CHOSEN_EFFECTS;
use spec::Fidelity;

use super::variant::Variant;

/// The effects and the tolerance of a plan. Rendered with them, a small picture has the errors of a large one, except the relative
/// part, which is far below any error of the model.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choices {
    pub(super) fidelity: Fidelity,
    pub(super) left_out: Vec<StageId>,
}

impl Choices {
    pub(super) fn of_plan(variant: &Variant, plan: &Plan) -> Self {
        let running = list_running(plan);
        let effects = CHOSEN_EFFECTS.into_iter();
        Self {
            fidelity: plan.tolerance.map_or(variant.fidelity, |tolerance| {
                Fidelity::Tolerance(tolerance.absolute)
            }),
            left_out: effects.filter(|id| !running.contains(id)).collect(),
        }
    }
}

/// The effects of a plan that it could leave out.
pub(super) fn list_running(plan: &Plan) -> Vec<StageId> {
    let effects = CHOSEN_EFFECTS.into_iter();
    effects.filter(|id| !plan.variant(*id).is_skipped()).collect()
}

#[cfg(test)]
mod tests {
    use optics::plan::{ErrorBound, Stage, Variant as Method};

    use super::*;

    #[test]
    fn a_plan_becomes_its_tolerance_and_the_effects_that_it_leaves_out() {
        let stages = vec![
            Stage::new(StageId::SunShadow, Method::Fast("f32")),
            Stage::skipped(StageId::LampShadows),
        ];
        let plan = Plan {
            tolerance: Some(ErrorBound::absolute(0.02)),
            stages,
        };
        let budget = Variant::plain(Fidelity::BudgetMs(60.0));
        let choices = Choices::of_plan(&budget, &plan);
        assert_eq!(choices.fidelity, Fidelity::Tolerance(0.02));
        assert!(choices.left_out.contains(&StageId::LampShadows));
        assert!(!choices.left_out.contains(&StageId::SunShadow));
        let fixed = Plan {
            tolerance: None,
            ..plan
        };
        let terms = Variant::plain(Fidelity::Terms(4));
        assert_eq!(Choices::of_plan(&terms, &fixed).fidelity, Fidelity::Terms(4));
    }
}
