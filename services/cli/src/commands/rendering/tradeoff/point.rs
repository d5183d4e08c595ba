//! A measured choice, and the front of those that no other beats.

use optics::plan::StageId;
use serde::Serialize;
use serde_json::{Value, json};

use super::variant::Variant;

/// Times closer than this share count as equal: the noise of repeated runs.
const SAME_TIME: f64 = 0.03;
/// Distances closer than this share of the light count as equal: a twentieth of the error of the truth.
const SAME_DISTANCE: f64 = 0.001;

/// A frame rendered with a choice.
pub(super) struct FramePoint {
    pub(super) frame: u64,
    /// Milliseconds; `None` without a measurement.
    pub(super) ms: Option<f64>,
    pub(super) planned_ms: Option<f64>,
    pub(super) tolerance: Option<f64>,
    /// The effects of its plan that plans may leave out.
    pub(super) effects: Vec<StageId>,
    pub(super) distance: Distance,
}

/// Distance from the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(super) struct Distance {
    pub(super) bias: f64,
    pub(super) rms: f64,
    pub(super) codes: f64,
}

impl Distance {
    /// The mean over frames.
    fn mean(frames: &[FramePoint]) -> Self {
        let mut mean = Self::default();
        for FramePoint { distance, .. } in frames {
            let share = 1.0 / frames.len() as f64;
            mean.bias += share * distance.bias;
            mean.rms += share * distance.rms;
            mean.codes += share * distance.codes;
        }
        mean
    }
}

/// A choice over all frames.
pub(super) struct Point {
    pub(super) variant: Variant,
    /// Choices with the same plans.
    pub(super) same_as: Vec<Variant>,
    pub(super) frames: Vec<FramePoint>,
    /// Median over the frames.
    pub(super) ms: Option<f64>,
    pub(super) planned_ms: Option<f64>,
    /// Means over the frames.
    pub(super) distance: Distance,
    /// No other choice that a job can make is quicker or nearer without being slower or farther.
    pub(super) is_pareto: bool,
}

impl Point {
    pub(super) fn new(variant: Variant, frames: Vec<FramePoint>) -> Self {
        Self {
            ms: median(frames.iter().map(|frame| frame.ms)),
            planned_ms: median(frames.iter().map(|frame| frame.planned_ms)),
            distance: Distance::mean(&frames),
            variant,
            same_as: Vec::new(),
            frames,
            is_pareto: false,
        }
    }

    /// Whether it is quicker and not farther, or nearer and not slower, beyond the uncertainties.
    fn beats(&self, other: &Self) -> bool {
        let (Some(ms), Some(other_ms)) = (self.ms, other.ms) else {
            return false;
        };
        let (rms, other_rms) = (self.distance.rms, other.distance.rms);
        let is_slower = ms > other_ms * (1.0 + SAME_TIME);
        let is_nearer = rms < other_rms - SAME_DISTANCE;
        let is_farther = rms > other_rms + SAME_DISTANCE;
        (ms < other_ms && !is_farther) || (is_nearer && !is_slower)
    }

    /// Whether a job can make this choice, and it was timed.
    fn is_selectable(&self) -> bool {
        self.variant.without.is_none() && self.ms.is_some()
    }

    pub(super) fn json(&self) -> Value {
        let frames = self.frames.iter().map(|frame| {
            json!({
                "frame": frame.frame,
                "ms": frame.ms,
                "planned_ms": frame.planned_ms,
                "tolerance": frame.tolerance,
                "effects": frame.effects.iter().map(|id| id.name()).collect::<Vec<_>>(),
                "distance": frame.distance,
            })
        });
        let fidelity = self.variant.value();
        json!({
            "kind": self.variant.kind().name(),
            "write": if fidelity.is_null() { Value::Null } else { json!({"fidelity": fidelity}) },
            "without": self.variant.without.map(StageId::name),
            "same_as": self.same_as.iter().map(Variant::value).collect::<Vec<_>>(),
            "default": self.variant.is_described,
            "pareto": self.is_pareto,
            "ms": self.ms,
            "planned_ms": self.planned_ms,
            "bias": self.distance.bias,
            "rms": self.distance.rms,
            "codes": self.distance.codes,
            "frames": frames.collect::<Vec<_>>(),
        })
    }
}

/// Marks the selectable points that no other selectable point beats.
pub(super) fn mark_front(points: &mut [Point]) {
    let is_front = points.iter().map(|one| {
        let mut rivals = points.iter().filter(|other| other.is_selectable());
        one.is_selectable() && !rivals.any(|rival| rival.beats(one))
    });
    let is_front: Vec<bool> = is_front.collect();
    for (point, is_pareto) in points.iter_mut().zip(is_front) {
        point.is_pareto = is_pareto;
    }
}

/// The median; `None` if a value is missing.
fn median(values: impl IntoIterator<Item = Option<f64>>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect::<Option<_>>()?;
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    let lower = values[(values.len() - 1) / 2];
    Some((lower + upper) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spec::Fidelity;

    fn point(ms: f64, rms: f64, without: Option<StageId>) -> Point {
        let variant = Variant {
            without,
            ..Variant::plain(Fidelity::Picture)
        };
        let distance = Distance {
            bias: 0.0,
            rms,
            codes: 0.0,
        };
        let frame = FramePoint {
            frame: 0,
            ms: Some(ms),
            planned_ms: None,
            tolerance: None,
            effects: Vec::new(),
            distance,
        };
        Point::new(variant, vec![frame])
    }

    #[test]
    fn the_front_has_no_point_that_another_clearly_beats() {
        let slower = point(200.0, 0.1, None);
        let mut points = vec![
            point(100.0, 0.1, None),
            slower,
            point(101.0, 0.1, None),
            point(50.0, 0.2, None),
            point(60.0, 0.2005, None),
            point(300.0, 0.05, None),
        ];
        mark_front(&mut points);
        let front: Vec<bool> = points.iter().map(|point| point.is_pareto).collect();
        assert_eq!(front, [true, false, false, true, false, true]);
    }

    #[test]
    fn a_choice_that_no_job_can_make_neither_is_on_the_front_nor_beats_others() {
        let mut points = vec![
            point(100.0, 0.1, None),
            point(10.0, 0.01, Some(StageId::LampShadows)),
        ];
        mark_front(&mut points);
        assert!(points[0].is_pareto && !points[1].is_pareto);
    }

    #[test]
    fn medians_need_all_values() {
        assert_eq!(median([Some(4.0), Some(1.0), Some(2.0)]), Some(2.0));
        assert_eq!(median([Some(4.0), Some(1.0)]), Some(2.5));
        assert_eq!(median([Some(4.0), None]), None);
    }
}
