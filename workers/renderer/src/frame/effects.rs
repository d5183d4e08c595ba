//! Effects that are rendered only if they visibly change the picture.

use std::collections::BTreeMap;

use optics::plan::{Stage, StageId};

/// An effect is left out if fewer pixels than this share change by more than [`VISIBLE_CODES`].
pub(crate) const LEAST_SHARE: f64 = 1e-3;
/// Largest change of an 8-bit picture that counts as invisible, codes.
pub(crate) const VISIBLE_CODES: f64 = 2.0;

/// Effects that a plan may leave out, by their estimated change, in the order of light.
pub const ESTIMATED: [StageId; 7] = [
    StageId::SunShadow,
    StageId::AmbientAccess,
    StageId::Caustics,
    StageId::Shafts,
    StageId::LampShadows,
    StageId::VeilOcclusion,
    StageId::Occlusion,
];

/// The estimated change of the final picture by an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Change {
    /// Share of the pixels that change by more than [`VISIBLE_CODES`] and more than the noise of the sensor.
    pub(crate) share: f64,
    /// Mean change of all pixels in codes.
    pub(crate) mean_codes: f64,
    /// Expected milliseconds of the effect.
    pub(crate) cost_ms: f64,
}

impl Change {
    fn is_visible(&self) -> bool {
        self.share >= LEAST_SHARE
    }

    /// Mean codes for each millisecond.
    fn gain_per_ms(&self) -> f64 {
        self.mean_codes / self.cost_ms.max(f64::MIN_POSITIVE)
    }

    fn describe(&self) -> String {
        format!(
            "{:.2} % of pixels by more than {VISIBLE_CODES} codes",
            100.0 * self.share
        )
    }
}

/// The estimated effects of a frame, by stage. Effects without an estimate always run.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Effects {
    estimated: BTreeMap<StageId, Change>,
    /// Effects dropped to meet a budget, and excluded ones.
    dropped: Vec<StageId>,
    /// How often a budget has doubled the tolerance.
    doublings: i32,
}

/// Number of times that a budget doubles the tolerance before it drops visible effects. Errors then stay within four codes, and
/// bounds are larger than errors.
const MOST_DOUBLINGS: i32 = 2;
/// The same after it has dropped all of them: forward scatter with a kernel or two is cheaper than light on surfaces.
const COARSEST_DOUBLINGS: i32 = 7;

impl Effects {
    pub(crate) fn add(&mut self, id: StageId, change: Change) {
        self.estimated.insert(id, change);
    }

    /// Leaves out an effect without naming it in plans.
    pub(crate) fn exclude(&mut self, id: StageId) {
        self.estimated.remove(&id);
        self.dropped.push(id);
    }

    /// Whether an effect runs.
    pub(crate) fn runs(&self, id: StageId) -> bool {
        let is_visible = self.estimated.get(&id).is_none_or(Change::is_visible);
        is_visible && !self.dropped.contains(&id)
    }

    /// The factor of the tolerance.
    pub(crate) fn tolerance_factor(&self) -> f64 {
        2f64.powi(self.doublings)
    }

    /// Makes a frame cheaper whose expected time is `excess_ms` too long: doubles the tolerance, then drops effects, then doubles it
    /// further. Returns `false` if no step is left.
    pub(crate) fn economize(&mut self, excess_ms: f64) -> bool {
        if self.doublings >= MOST_DOUBLINGS && self.drop_least(excess_ms) {
            return true;
        }
        let is_finer = self.doublings < COARSEST_DOUBLINGS;
        self.doublings += i32::from(is_finer);
        is_finer
    }

    /// Drops running effects that together take `excess_ms`, or all, those with the smallest change per millisecond first. Returns
    /// whether there was one.
    fn drop_least(&mut self, excess_ms: f64) -> bool {
        let running = self.estimated.iter().filter(|(id, _)| self.runs(**id));
        let mut running: Vec<(StageId, Change)> = running.map(|(id, change)| (*id, *change)).collect();
        running.sort_by(|(_, a), (_, b)| a.gain_per_ms().total_cmp(&b.gain_per_ms()));
        let mut saved_ms = 0.0;
        for (id, change) in &running {
            self.dropped.push(*id);
            saved_ms += change.cost_ms;
            if saved_ms >= excess_ms {
                break;
            }
        }
        !running.is_empty()
    }

    /// Adds the estimated changes to the stages of a plan.
    pub(crate) fn annotate(&self, stages: &mut Vec<Stage>) {
        for (id, change) in &self.estimated {
            let described = change.describe();
            if self.runs(*id) {
                if let Some(stage) = stages.iter_mut().find(|stage| stage.id == *id) {
                    let rest = stage.note.take().map(|note| format!("; {note}"));
                    stage.note = Some(format!("changes {described}{}", rest.unwrap_or_default()));
                }
                continue;
            }
            let reason = if self.dropped.contains(id) {
                "left out by `fidelity.budget_ms`"
            } else {
                "skipped"
            };
            stages.retain(|stage| stage.id != *id);
            stages.push(Stage {
                note: Some(format!(
                    "{reason}, would change {described}, saves {:.0} ms",
                    change.cost_ms
                )),
                bound: None,
                ..Stage::skipped(*id)
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(share: f64, mean_codes: f64, cost_ms: f64) -> Change {
        Change {
            share,
            mean_codes,
            cost_ms,
        }
    }

    #[test]
    fn a_budget_drops_the_least_gain_for_its_time_first() {
        let mut effects = Effects::default();
        effects.add(StageId::SunShadow, change(0.2, 8.0, 10.0));
        effects.add(StageId::AmbientAccess, change(0.3, 4.0, 40.0));
        effects.add(StageId::Caustics, change(0.0, 0.1, 30.0));
        assert!(!effects.runs(StageId::Caustics), "it is not visible");
        assert!(effects.drop_least(10.0));
        assert!(effects.runs(StageId::SunShadow) && !effects.runs(StageId::AmbientAccess));
        assert!(effects.drop_least(1.0));
        assert!(!effects.drop_least(1.0));
    }

    #[test]
    fn a_budget_drops_as_many_effects_as_it_needs_and_then_accuracy() {
        let mut effects = Effects::default();
        effects.add(StageId::SunShadow, change(0.2, 8.0, 10.0));
        effects.add(StageId::AmbientAccess, change(0.3, 4.0, 40.0));
        effects.add(StageId::LampShadows, change(0.3, 80.0, 40.0));
        let factors = |effects: &mut Effects, steps: usize| {
            (0..steps).for_each(|_| assert!(effects.economize(45.0)));
            effects.tolerance_factor()
        };
        assert_eq!(factors(&mut effects, 2), 4.0);
        assert!(effects.runs(StageId::AmbientAccess), "accuracy goes first");
        assert_eq!(factors(&mut effects, 1), 4.0);
        assert!(
            effects.runs(StageId::LampShadows),
            "two of three effects are enough"
        );
        assert!(!effects.runs(StageId::SunShadow) && !effects.runs(StageId::AmbientAccess));
        assert_eq!(factors(&mut effects, 6), 128.0);
        assert!(!effects.economize(45.0));
    }

    #[test]
    fn a_plan_lists_what_was_left_out_and_why() {
        let mut effects = Effects::default();
        effects.add(StageId::LampShadows, change(4e-4, 0.01, 21.0));
        let mut stages = Vec::new();
        effects.annotate(&mut stages);
        let note = "skipped, would change 0.04 % of pixels by more than 2 codes, saves 21 ms";
        assert_eq!(stages[0].note.as_deref(), Some(note));
        assert!(stages[0].variant.is_skipped());
    }
}
