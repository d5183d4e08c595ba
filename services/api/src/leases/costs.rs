//! Cost estimates: typical figures at first, then corrected by the frames of the same kind rendered here.

mod kind;
mod typical;

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};

use catalogue::Price;
use spec::{Frame, FrameRecord};

use kind::WorkKind;
use typical::{traced_seconds, typical_bytes, typical_seconds};

use super::table::OpenCost;

/// Frames of a kind whose costs are kept: their median ignores outliers.
const KEPT: usize = 9;
/// Maximum learned kinds; beyond it all are learned again.
const MAX_KINDS: usize = 256;
/// Maximum ratio of a measured cost to the typical one, and its inverse the minimum.
const WIDEST: f64 = 1000.0;
/// Stage of the Monte Carlo trace in a record's times.
const TRACED: &str = "truth";

/// Costs learned from rendered frames.
#[derive(Default)]
pub(crate) struct Costs(Mutex<BTreeMap<WorkKind, Measured>>);

/// The latest measured costs of a kind, relative to the typical ones.
#[derive(Default)]
struct Measured {
    time: VecDeque<f64>,
    bytes: VecDeque<f64>,
}

/// A frame of a job and its number of pixels.
pub(crate) struct Sized<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) pixels: f64,
}

/// The cost of some frames.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Cost {
    /// Mean seconds of one slot.
    pub(crate) seconds: f64,
    /// Mean bytes.
    pub(crate) bytes: f64,
    /// Seconds of the most expensive frame.
    pub(crate) most_seconds: f64,
    /// Whether frames of the kind of each were rendered here.
    pub(crate) is_measured: bool,
}

/// A price as the lease table counts it.
pub(crate) fn count_price(price: &Price) -> OpenCost {
    OpenCost {
        us: (price.slot_seconds * 1e6) as u64,
        bytes: price.bytes,
    }
}

impl Costs {
    /// Learns from a rendered frame.
    pub(crate) fn learn(&self, frame: &Frame, record: &FrameRecord) {
        let camera = &record.parameters["camera"];
        let sides = (camera["width"].as_f64(), camera["height"].as_f64());
        let (Some(width), Some(height)) = sides else {
            return;
        };
        let pixels = (width * height).max(1.0);
        let seconds = stage_seconds(record, "total") - stage_seconds(record, TRACED);
        let bytes: u64 = record.artifacts.iter().map(|artifact| artifact.bytes).sum();
        let kind = WorkKind::new(frame, pixels);
        let mut learned = self.learned();
        if learned.len() == MAX_KINDS && !learned.contains_key(&kind) {
            learned.clear();
        }
        let measured = learned.entry(kind).or_default();
        record_ratio(&mut measured.time, seconds / typical_seconds(frame, pixels));
        record_ratio(&mut measured.bytes, bytes as f64 / typical_bytes(frame, pixels));
    }

    /// The cost of these frames.
    pub(crate) fn estimate(&self, frames: &[Sized<'_>]) -> Cost {
        let learned = self.learned();
        let mut cost = Cost {
            is_measured: !frames.is_empty(),
            ..Cost::default()
        };
        let count = frames.len().max(1) as f64;
        for Sized { frame, pixels } in frames {
            let measured = learned.get(&WorkKind::new(frame, *pixels));
            cost.is_measured &= measured.is_some_and(|kept| !kept.time.is_empty());
            let (time, size) = measured.map_or((1.0, 1.0), |kept| (median(&kept.time), median(&kept.bytes)));
            // The trace may end early, but need not: it is always priced at its most.
            let seconds = typical_seconds(frame, *pixels) * time + traced_seconds(frame, *pixels);
            let bytes = typical_bytes(frame, *pixels) * size;
            cost.seconds += seconds / count;
            cost.bytes += bytes / count;
            cost.most_seconds = cost.most_seconds.max(seconds);
        }
        cost
    }

    fn learned(&self) -> MutexGuard<'_, BTreeMap<WorkKind, Measured>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn stage_seconds(record: &FrameRecord, stage: &str) -> f64 {
    record.timings_ms.get(stage).copied().unwrap_or(0.0) / 1000.0
}

/// Keeps a ratio in place of the oldest; frames without a measurement have none.
fn record_ratio(kept: &mut VecDeque<f64>, ratio: f64) {
    if ratio > 0.0 && ratio.is_finite() {
        if kept.len() == KEPT {
            kept.pop_front();
        }
        kept.push_back(ratio.clamp(1.0 / WIDEST, WIDEST));
    }
}

/// The median, or 1 without any.
fn median(kept: &VecDeque<f64>) -> f64 {
    let mut sorted: Vec<f64> = kept.iter().copied().collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(1.0)
}

#[cfg(test)]
mod tests;
