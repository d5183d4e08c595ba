//! Number of features, see [`FrameFeatures`].

use crate::matching::features::{FrameFeatures, Threshold};
use crate::work::{MetricInput, SharedPart};

/// Features at the adaptive threshold, 0..=1000.
pub(crate) fn adaptive(work: &MetricInput) -> f64 {
    count(work, Threshold::Adaptive)
}

/// Features at the default threshold, 0..=1000.
pub(crate) fn default(work: &MetricInput) -> f64 {
    count(work, Threshold::Default)
}

fn count(work: &MetricInput, threshold: Threshold) -> f64 {
    let count = match work.subject().sequence {
        Some(sequence) => sequence.features.with_threshold(threshold).count(),
        None => work.part::<FoundFeatures>().0.with_threshold(threshold).count(),
    };
    count as f64
}

/// Features of a picture outside of a sequence.
struct FoundFeatures(FrameFeatures);

impl SharedPart for FoundFeatures {
    fn new(work: &MetricInput) -> Self {
        Self(FrameFeatures::find(work.picture(), work.mask()))
    }
}
