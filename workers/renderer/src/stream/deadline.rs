//! Plans that meet a deadline. Plans expect the costs of a reference machine; a calibration scales them to this one, with a factor
//! for each timing.

use std::collections::BTreeMap;

use spec::{FrameRecord, RangeKind};

use super::input::{ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamInput, StreamPicture};
use super::output::StreamFrame;
use crate::slot::costs::{CostScale, StageCost, is_effect, timing};

/// Columns and rows of the pictures of a calibration.
const SIZE: (usize, usize) = (384, 246);
/// Pictures of a calibration with each plan. The first one fills the caches.
pub(super) const FRAMES: u64 = 4;
/// Smallest budget, ms: the cheapest plan.
pub(super) const LEAST_MS: f64 = 1e-3;
/// Distances of the slanted wall, the posts in front of it, and their columns: each post and each gap.
const WALL_M: [f32; 2] = [2.0, 6.0];
const POST_M: f32 = 1.5;
const POST_COLUMNS: usize = 24;

/// The pictures of a calibration: a slanted wall behind posts, whose edges make shadows and gates as expensive as those of usual
/// scenes.
pub(super) struct CalibrationPicture {
    codes: Vec<u8>,
    meters: Vec<f32>,
}

impl CalibrationPicture {
    pub(super) fn new() -> Self {
        let (width, height) = SIZE;
        let meters = |i: usize| {
            let column = i % width;
            let wall = WALL_M[0] + (WALL_M[1] - WALL_M[0]) * column as f32 / width as f32;
            let is_post = (column / POST_COLUMNS) % 4 == 1 && i / width > height / 3;
            if is_post { POST_M } else { wall }
        };
        Self {
            codes: (0..3 * width * height).map(|i| (i % 251) as u8).collect(),
            meters: (0..width * height).map(meters).collect(),
        }
    }

    pub(super) fn input(&self, stamp_ns: u64) -> StreamInput<'_> {
        StreamInput {
            picture: StreamPicture {
                size: SIZE,
                channels: ChannelOrder::Rgb,
                samples: PictureSamples::Srgb(&self.codes),
            },
            depth: Some(StreamDepth {
                kind: RangeKind::Range,
                size: SIZE,
                samples: DepthSamples::Meters(&self.meters),
            }),
            instances: None,
            camera: None,
            stamp_ns: Some(stamp_ns),
            pose: None,
        }
    }
}

/// A frame, and the costs of its plan.
pub(super) struct PlannedFrame {
    pub(super) frame: StreamFrame,
    pub(super) costs: Vec<StageCost>,
}

/// Frames of a calibration, without those that fill the caches.
pub(super) struct Calibration {
    /// With the cheapest plan.
    pub(super) cheap: Vec<PlannedFrame>,
    /// With all visible effects.
    pub(super) full: Vec<PlannedFrame>,
}

/// The time of frames on this machine.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CostModel {
    deadline_ms: f64,
    scale: CostScale,
    /// Milliseconds of everything else, by pixel: decoding, planning, encoding, enhancement.
    rest_ms: f64,
}

impl CostModel {
    /// Fits the model to the minimum of each time, since disturbances only add to it.
    pub(super) fn new(deadline_ms: f64, calibration: &Calibration) -> Self {
        let (width, height) = SIZE;
        let (cheap, full) = (Times::new(&calibration.cheap), Times::new(&calibration.full));
        let mut scale = CostScale::default();
        let mut planned_ms = 0.0;
        for (&timing, expected) in &cheap.expected {
            let ms = cheap.ms(timing);
            planned_ms += ms;
            scale.base.insert(timing, ms / (expected.base + expected.effects));
        }
        for (&timing, expected) in full
            .expected
            .iter()
            .filter(|(_, expected)| expected.effects > 0.0)
        {
            let base_ms = scale
                .base
                .get(timing)
                .map_or(0.0, |factor| factor * expected.base);
            let ms = (full.ms(timing) - base_ms).max(0.0);
            scale.effects.insert(timing, ms / expected.effects);
        }
        Self {
            deadline_ms,
            scale,
            rest_ms: (cheap.ms("total") - planned_ms).max(0.0) / (width * height) as f64,
        }
    }

    pub(super) fn scale(&self) -> &CostScale {
        &self.scale
    }

    /// Milliseconds left for the planned stages of a picture.
    pub(super) fn budget_ms(&self, (width, height): (usize, usize)) -> f64 {
        (self.deadline_ms - self.rest_ms * (width * height) as f64).max(LEAST_MS)
    }

    /// Replaces the warning about the budget by one about the deadline if the plan is expected to miss it.
    pub(super) fn correct_warnings(
        &self,
        record: &mut FrameRecord,
        costs: &[StageCost],
        size: (usize, usize),
    ) {
        record
            .warnings
            .retain(|warning| !warning.starts_with("`fidelity.budget_ms`"));
        let rest_ms = self.rest_ms * (size.0 * size.1) as f64;
        let expected = self.scale.expect_ms(costs) + rest_ms;
        if expected > self.deadline_ms {
            record.warnings.push(format!(
                "`deadline_ms` is {}, but the cheapest plan is expected to take {expected:.1} ms; raise it or make the picture smaller",
                self.deadline_ms
            ));
        }
    }
}

/// Expected milliseconds of the stages in one timing.
#[derive(Debug, Clone, Copy, Default)]
struct Expected {
    base: f64,
    effects: f64,
}

/// Measured and expected times of frames with one plan.
struct Times<'a> {
    frames: &'a [PlannedFrame],
    expected: BTreeMap<&'static str, Expected>,
}

impl<'a> Times<'a> {
    fn new(frames: &'a [PlannedFrame]) -> Self {
        let mut expected = BTreeMap::<_, Expected>::new();
        for StageCost { id, ms } in frames.last().into_iter().flat_map(|frame| &frame.costs) {
            let sum = expected.entry(timing(*id)).or_default();
            if is_effect(*id) {
                sum.effects += ms;
            } else {
                sum.base += ms;
            }
        }
        Self { frames, expected }
    }

    /// The shortest time of a stage.
    fn ms(&self, timing: &str) -> f64 {
        let times = (self.frames.iter()).filter_map(|planned| planned.frame.record.timings_ms.get(timing));
        times.copied().reduce(f64::min).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
