//! The open frames of one job. Fresh frames are a cursor, so a job of ten million takes no memory.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::types::{JobEntry, Millis};

/// A frame that kills its worker or fails this often is given up.
pub(crate) const STRIKES: u32 = 3;
/// First pause after a failure; it doubles with each strike, so that a fault which passes has time to pass.
const PAUSE_MS: u64 = 1000;
const LONGEST_PAUSE_MS: u64 = 30_000;

pub(crate) struct Job {
    pub(crate) priority: i32,
    pub(crate) held_back: bool,
    pub(crate) cancelled: bool,
    /// When it was served last, in grants: the longest waiting goes first.
    pub(crate) served: u64,
    pub(crate) leased: u64,
    frames: u64,
    finished: u64,
    cursor: u64,
    /// Ranges ahead of the cursor that are finished already: start → end.
    skipped: BTreeMap<u64, u64>,
    /// Ranges that were handed back: start → end.
    returned: BTreeMap<u64, u64>,
    /// Frames that were in a lease that was lost: tried one at a time.
    alone: BTreeSet<u64>,
    /// Frames that pause after a failure.
    pausing: BTreeSet<(Millis, u64)>,
    strikes: BTreeMap<u64, u32>,
}

impl Job {
    pub(crate) fn new(entry: &JobEntry) -> Self {
        let mut skipped = BTreeMap::new();
        let failed = entry.failed.iter().map(|&frame| frame..frame + 1);
        let mut finished = 0;
        for range in entry.done.iter().cloned().chain(failed) {
            finished += range.end.saturating_sub(range.start);
            skipped.insert(range.start, range.end);
        }
        // What struck before is tried alone at once and not met by the cursor again.
        for &frame in entry.strikes.keys() {
            skipped.insert(frame, frame + 1);
        }
        Self {
            priority: entry.priority,
            held_back: entry.paused,
            cancelled: false,
            served: 0,
            leased: 0,
            frames: entry.frames,
            finished,
            cursor: 0,
            skipped,
            returned: BTreeMap::new(),
            alone: entry.strikes.keys().copied().collect(),
            pausing: BTreeSet::new(),
            strikes: entry.strikes.clone(),
        }
    }

    /// Frames that are neither finished nor held.
    pub(crate) fn queued(&self) -> u64 {
        if self.cancelled {
            0
        } else {
            self.frames - self.finished - self.leased
        }
    }

    pub(crate) fn finished(&self) -> bool {
        self.finished == self.frames
    }

    /// The attempt that a lease of this frame would be.
    pub(crate) fn attempt(&self, frame: u64) -> u32 {
        self.strikes.get(&frame).copied().unwrap_or(0) + 1
    }

    /// The next frames, at most `most`; frames that are tried alone come one at a time.
    pub(crate) fn take(&mut self, most: u64, now: Millis) -> Option<Range<u64>> {
        if self.held_back || self.cancelled {
            return None;
        }
        if let Some(&(until, frame)) = self.pausing.first()
            && until <= now
        {
            self.pausing.pop_first();
            return Some(self.leave(frame..frame + 1));
        }
        if let Some(frame) = self.alone.pop_first() {
            return Some(self.leave(frame..frame + 1));
        }
        if let Some((start, end)) = self.returned.pop_first() {
            let stop = end.min(start + most);
            if stop < end {
                self.returned.insert(stop, end);
            }
            return Some(self.leave(start..stop));
        }
        self.fresh(most)
    }

    fn fresh(&mut self, most: u64) -> Option<Range<u64>> {
        while let Some((&start, &end)) = self.skipped.first_key_value()
            && start <= self.cursor
        {
            self.cursor = self.cursor.max(end);
            self.skipped.pop_first();
        }
        let end = self
            .skipped
            .first_key_value()
            .map_or(self.frames, |(&start, _)| start);
        let stop = end.min(self.cursor.saturating_add(most));
        if self.cursor >= stop {
            return None;
        }
        let frames = self.cursor..stop;
        self.cursor = stop;
        Some(self.leave(frames))
    }

    fn leave(&mut self, frames: Range<u64>) -> Range<u64> {
        self.leased += frames.end - frames.start;
        frames
    }

    /// A frame has its image.
    pub(crate) fn complete(&mut self, frame: u64) {
        self.leased -= 1;
        self.finished += 1;
        self.strikes.remove(&frame);
    }

    /// A frame comes back unharmed.
    pub(crate) fn give_back(&mut self, frame: u64) {
        self.leased -= 1;
        if self.strikes.contains_key(&frame) {
            self.alone.insert(frame);
        } else {
            let before = self
                .returned
                .range(..frame)
                .next_back()
                .filter(|(_, end)| **end == frame);
            let start = before.map_or(frame, |(&start, _)| start);
            self.returned.insert(start, frame + 1);
        }
    }

    /// A frame was in a lease that was lost together with others.
    pub(crate) fn single_out(&mut self, frame: u64) {
        self.leased -= 1;
        self.alone.insert(frame);
    }

    /// An attempt at a frame failed; answers the strikes and whether the frame is given up.
    pub(crate) fn strike(&mut self, frame: u64, retryable: bool, now: Millis) -> (u32, bool) {
        self.leased -= 1;
        let strikes = self.attempt(frame);
        if !retryable || strikes >= STRIKES {
            self.strikes.remove(&frame);
            self.finished += 1;
            return (strikes, true);
        }
        self.strikes.insert(frame, strikes);
        let pause = (PAUSE_MS << (strikes - 1)).min(LONGEST_PAUSE_MS);
        self.pausing.insert((now.plus(pause), frame));
        (strikes, false)
    }
}
