//! The open frames of one job. A cursor represents fresh frames, so that ten million take no memory.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::line::Micros;
use super::types::{JobEntry, Millis, OpenCost, Toolchain};

/// A frame that kills its worker or fails this often is quarantined.
const STRIKES: u32 = 3;
/// First pause after a failure. It doubles with each strike, which gives transient faults time to pass.
const PAUSE_MS: u64 = 1000;
const LONGEST_PAUSE_MS: u64 = 30_000;
/// Least price of a frame: storing it takes as long.
const LEAST_PRICE_US: Micros = 1000;

pub(crate) struct Job {
    pub(crate) caller: String,
    /// Price of a frame.
    pub(crate) frame_cost: OpenCost,
    pub(crate) held_back: bool,
    /// Whether its frames may come from different programs and machines.
    pub(crate) mixed: bool,
    /// Provenance of its images; `None` before the first.
    pub(crate) made: Option<Toolchain>,
    /// Running mean of the slot time of its frames; `None` before the first.
    measured_us: Option<Micros>,
    frames: u64,
    finished: u64,
    /// Whether any frame has an image.
    has_images: bool,
    leased: u64,
    cursor: u64,
    /// Ranges beyond the cursor to skip: start → end.
    skipped: BTreeMap<u64, u64>,
    /// Returned ranges: start → end.
    returned: BTreeMap<u64, u64>,
    /// Frames offered one at a time.
    alone: BTreeSet<u64>,
    /// Frames pausing after a failure, then offered one at a time.
    pausing: BTreeSet<(Millis, u64)>,
    strikes: BTreeMap<u64, u32>,
    given_up: BTreeSet<u64>,
}

/// Consequence of a strike.
pub(crate) struct Struck {
    pub(crate) strikes: u32,
    /// Time of the next attempt; `None`: quarantined.
    pub(crate) again: Option<Millis>,
}

impl Job {
    pub(crate) fn new(entry: &JobEntry) -> Self {
        let mut job = Self {
            caller: entry.caller.clone(),
            frame_cost: OpenCost {
                us: entry.frame_cost.us.max(LEAST_PRICE_US),
                ..entry.frame_cost
            },
            held_back: entry.paused,
            measured_us: None,
            mixed: entry.mixed,
            made: entry.made.clone(),
            frames: entry.frames,
            finished: 0,
            has_images: !entry.done.is_empty(),
            leased: 0,
            cursor: 0,
            skipped: BTreeMap::new(),
            returned: BTreeMap::new(),
            alone: BTreeSet::new(),
            pausing: BTreeSet::new(),
            strikes: BTreeMap::new(),
            given_up: entry
                .failed
                .iter()
                .copied()
                .filter(|&f| f < entry.frames)
                .collect(),
        };
        let failed = entry.failed.iter().map(|&frame| frame..frame + 1);
        let mut closed: Vec<Range<u64>> = entry.done.iter().cloned().chain(failed).collect();
        closed.sort_unstable_by_key(|range| range.start);
        let mut covered = 0;
        for range in closed {
            let (start, end) = (range.start.max(covered), range.end.min(entry.frames));
            if start < end {
                job.skipped.insert(start, end);
                job.finished += end - start;
                covered = end;
            }
        }
        // Frames with strikes are retried alone and skipped by the cursor.
        for (&frame, &strikes) in &entry.strikes {
            let before = job.skipped.range(..=frame).next_back();
            if frame < entry.frames && before.is_none_or(|(_, &end)| end <= frame) {
                job.skipped.insert(frame, frame + 1);
                job.alone.insert(frame);
                job.strikes.insert(frame, strikes);
            }
        }
        job
    }

    /// Frames that are neither finished nor leased.
    pub(crate) fn queued(&self) -> u64 {
        self.frames - self.finished - self.leased
    }

    /// Price of the unfinished frames.
    pub(crate) fn open_cost(&self) -> OpenCost {
        self.frame_cost.times(self.frames - self.finished)
    }

    /// Expected slot time of a frame for a worker whose frames took `frame_ms` recently.
    pub(crate) fn expected_ms(&self, frame_ms: f64) -> f64 {
        match self.measured_us {
            Some(us) => us.max(1) as f64 / 1000.0,
            None => frame_ms.max(self.frame_cost.us as f64 / 1000.0),
        }
    }

    /// Counts the slot time of a frame.
    pub(crate) fn record_time(&mut self, us: Micros) {
        self.measured_us = Some(match self.measured_us {
            Some(mean) => mean / 4 * 3 + us / 4,
            None => us,
        });
    }

    /// Leased frames.
    pub(crate) fn leased(&self) -> u64 {
        self.leased
    }

    /// Whether no frame has its image.
    pub(crate) fn is_untouched(&self) -> bool {
        !self.has_images
    }

    pub(crate) fn finished(&self) -> bool {
        self.finished == self.frames
    }

    /// The number of the next attempt of this frame.
    pub(crate) fn attempt(&self, frame: u64) -> u32 {
        self.strikes.get(&frame).copied().unwrap_or(0) + 1
    }

    /// The next frames, at most `most`; frames with earlier trouble come one at a time.
    pub(crate) fn take(&mut self, most: u64, now: Millis) -> Option<Range<u64>> {
        if self.held_back {
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

    /// Leases out a suspect.
    pub(crate) fn take_suspect(&mut self, frame: u64) -> Range<u64> {
        self.leave(frame..frame + 1)
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

    /// Marks a frame as done.
    pub(crate) fn complete(&mut self, frame: u64) {
        self.leased -= 1;
        self.finished += 1;
        self.has_images = true;
        self.strikes.remove(&frame);
    }

    /// Returns a frame to the queue without a strike.
    pub(crate) fn give_back(&mut self, frame: u64) {
        self.leased -= 1;
        if self.strikes.contains_key(&frame) {
            self.alone.insert(frame);
            return;
        }
        let before = self
            .returned
            .range(..frame)
            .next_back()
            .filter(|(_, end)| **end == frame);
        let start = before.map_or(frame, |(&start, _)| start);
        self.returned.insert(start, frame + 1);
    }

    /// Offers a frame alone from now on, because a larger lease with it was lost.
    pub(crate) fn single_out(&mut self, frame: u64) {
        self.leased -= 1;
        self.alone.insert(frame);
    }

    /// Returns the frame to the lease table, which quarantines it as a suspect.
    pub(crate) fn suspect(&mut self) {
        self.leased -= 1;
    }

    /// Counts a failed attempt; the caller decides where the frame waits.
    pub(crate) fn strike(&mut self, frame: u64, retryable: bool, now: Millis) -> Struck {
        self.leased -= 1;
        let strikes = self.attempt(frame);
        if !retryable || strikes >= STRIKES {
            self.strikes.remove(&frame);
            self.given_up.insert(frame);
            self.finished += 1;
            return Struck { strikes, again: None };
        }
        self.strikes.insert(frame, strikes);
        let pause = (PAUSE_MS << (strikes - 1)).min(LONGEST_PAUSE_MS);
        Struck {
            strikes,
            again: Some(now.plus(pause)),
        }
    }

    /// Offers a quarantined frame again without its strikes. Other frames are unchanged.
    pub(crate) fn retry(&mut self, frame: u64) {
        if self.given_up.remove(&frame) {
            self.finished -= 1;
            self.alone.insert(frame);
        }
    }

    /// Offers a frame again that has lost its image.
    pub(crate) fn reopen(&mut self, frame: u64) {
        self.finished -= 1;
        self.alone.insert(frame);
    }

    /// Offers a frame again, after a pause.
    pub(crate) fn pause(&mut self, frame: u64, until: Millis) {
        self.pausing.insert((until, frame));
    }
}
