//! Plans that meet a deadline. Plans expect the costs of a reference machine; a calibration scales them to this one.

use std::collections::BTreeMap;

use serde_json::Value;
use spec::FrameRecord;

/// Stages whose cost a plan states, as named in timings.
const PLANNED: [&str; 8] = [
    "above",
    "turbidity",
    "lamps",
    "water",
    "snow",
    "camera",
    "style",
    "haze",
];
/// Smallest budget, ms: the cheapest plan.
const LEAST_MS: f64 = 1e-3;
/// Columns and rows of the pictures of a calibration.
pub(super) const CALIBRATION_SIZE: (usize, usize) = (384, 246);
/// Pictures of a calibration. The first one fills the caches.
pub(super) const CALIBRATION_FRAMES: u64 = 4;

/// The time of frames on this machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CostModel {
    deadline_ms: f64,
    /// Milliseconds of the planned stages for each expected millisecond.
    slowness: f64,
    /// Milliseconds of everything else, by pixel: decoding, planning, encoding, enhancement.
    rest_ms: f64,
}

impl CostModel {
    /// Fits the model to all frames but the first. It takes the minimum of each share, since disturbances only add time.
    pub(super) fn new(deadline_ms: f64, records: &[FrameRecord]) -> Self {
        let (width, height) = CALIBRATION_SIZE;
        let warm = records.iter().skip(1);
        let shares = warm.map(|record| {
            let planned = sum_planned(&record.timings_ms);
            let rest = record.timings_ms.get("total").copied().unwrap_or_default() - planned;
            (planned / expect_ms(&record.plan).max(LEAST_MS), rest)
        });
        let (slowness, rest) = shares
            .reduce(|a, b| (a.0.min(b.0), a.1.min(b.1)))
            .unwrap_or((1.0, 0.0));
        Self {
            deadline_ms,
            slowness: slowness.max(f64::MIN_POSITIVE),
            rest_ms: rest.max(0.0) / (width * height) as f64,
        }
    }

    /// Expected milliseconds left for the planned stages of a picture, in the unit of plans.
    pub(super) fn budget_ms(&self, (width, height): (usize, usize)) -> f64 {
        let left = self.deadline_ms - self.rest_ms * (width * height) as f64;
        (left / self.slowness).max(LEAST_MS)
    }

    /// Replaces the warning about the budget by one about the deadline if the plan is expected to miss it.
    pub(super) fn correct_warnings(&self, record: &mut FrameRecord, (width, height): (usize, usize)) {
        record
            .warnings
            .retain(|warning| !warning.starts_with("`fidelity.budget_ms`"));
        let expected = self.slowness * expect_ms(&record.plan) + self.rest_ms * (width * height) as f64;
        if expected > self.deadline_ms {
            record.warnings.push(format!(
                "`deadline_ms` is {}, but the cheapest plan is expected to take {expected:.1} ms; raise it or make the picture smaller",
                self.deadline_ms
            ));
        }
    }
}

fn sum_planned(timings_ms: &BTreeMap<String, f64>) -> f64 {
    PLANNED.iter().filter_map(|stage| timings_ms.get(*stage)).sum()
}

/// Sum of the costs that a plan states.
fn expect_ms(plan: &Value) -> f64 {
    let stages = plan.as_array().into_iter().flatten();
    stages.filter_map(|stage| stage["cost_ms"].as_f64()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn record(water_ms: f64, total_ms: f64) -> FrameRecord {
        FrameRecord {
            plan: json!([{"stage": "attenuation", "cost_ms": 6.0}, {"stage": "haze", "cost_ms": 4.0}]),
            timings_ms: [("water", water_ms), ("encode", 3.0), ("total", total_ms)]
                .map(|(name, ms)| (name.to_owned(), ms))
                .into(),
            ..FrameRecord::default()
        }
    }

    #[test]
    fn a_budget_is_the_rest_of_the_deadline_in_the_unit_of_plans() {
        let model = CostModel::new(
            66.0,
            &[record(500.0, 900.0), record(21.0, 27.0), record(20.0, 26.5)],
        );
        let (width, height) = CALIBRATION_SIZE;
        // 20 ms for 10 expected ones, and 6 ms of a picture that are not planned.
        assert!((model.budget_ms((width, height)) - 30.0).abs() < 1e-9);
        assert!((model.budget_ms((width, 2 * height)) - 27.0).abs() < 1e-9);
        assert_eq!(model.budget_ms((width, 100 * height)), LEAST_MS);
    }

    #[test]
    fn a_frame_that_will_be_late_says_so_in_terms_of_the_deadline() {
        let frames = [record(500.0, 900.0), record(20.0, 26.0)];
        let warn = |deadline_ms: f64| {
            let mut record = record(0.0, 0.0);
            record.warnings = vec!["`fidelity.budget_ms` is 3, but …".to_owned(), "kept".to_owned()];
            CostModel::new(deadline_ms, &frames).correct_warnings(&mut record, CALIBRATION_SIZE);
            record.warnings
        };
        assert_eq!(warn(26.1), ["kept"]);
        let late = "`deadline_ms` is 25, but the cheapest plan is expected to take 26.0 ms; raise it or make the picture smaller";
        assert_eq!(warn(25.0), ["kept", late]);
    }
}
