//! A sequence, and its texts.

use crate::commands::dataset::export::formats::sequences::timed_frame::TimedFrame;

const NS_PER_S: f64 = 1e9;

/// The frames of a sequence in the order of time.
pub(crate) struct Sequence {
    pub(super) name: String,
    /// Frames that have a place.
    pub(super) placed: usize,
    pub(crate) frames: Vec<TimedFrame>,
}

/// A text in a folder of a sequence.
pub(crate) struct TextFile {
    pub(super) folders: Vec<String>,
    pub(super) name: String,
    pub(super) text: String,
}

impl TextFile {
    pub(super) fn new(folders: &[&str], name: &str, text: String) -> Self {
        Self {
            folders: folders.iter().map(|folder| (*folder).to_owned()).collect(),
            name: name.to_owned(),
            text,
        }
    }
}

impl Sequence {
    /// A line for each frame below a head.
    pub(super) fn list(&self, head: &str, line: impl Fn(&TimedFrame) -> String) -> String {
        let lines = self.frames.iter().map(line);
        let lines: Vec<String> = std::iter::once(head.to_owned()).chain(lines).collect();
        lines.join("\n") + "\n"
    }

    /// Rate by the median interval; 0 for a single frame, which ORB-SLAM reads as unknown.
    pub(super) fn rate_hz(&self) -> f64 {
        let pairs = self.frames.windows(2);
        let mut intervals: Vec<u64> = pairs.map(|pair| pair[1].stamp_ns - pair[0].stamp_ns).collect();
        intervals.sort_unstable();
        let median = intervals.get(intervals.len() / 2);
        median.map_or(0.0, |median| NS_PER_S / *median as f64)
    }

    /// Velocity of each frame in the world, m/s: from the frame before to the one after, as far as there are any.
    pub(super) fn velocities(&self) -> Vec<[f64; 3]> {
        let last = self.frames.len().saturating_sub(1);
        let velocities = (0..self.frames.len()).map(|index| {
            let (before, after) = (
                &self.frames[index.saturating_sub(1)],
                &self.frames[last.min(index + 1)],
            );
            let seconds = (after.stamp_ns - before.stamp_ns) as f64 / NS_PER_S;
            let (from, to) = (before.view.position(), after.view.position());
            [0, 1, 2].map(|at| {
                if seconds > 0.0 {
                    (to[at] - from[at]) / seconds
                } else {
                    0.0
                }
            })
        });
        velocities.collect()
    }
}
