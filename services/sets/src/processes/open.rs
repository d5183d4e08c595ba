//! The frames of a shard: waiting ones, and ones finished before an older one.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::error::SetError;
use crate::processes::message::{Message, ParcelFile};

/// Frames that may be finished before an older one is, for each slot.
const AHEAD_PER_SLOT: u64 = 4;
/// Memory for finished frames that wait for an earlier one; beyond it no frame is started.
const MOST_WAITING_BYTES: usize = 128 << 20;

/// A finished frame.
#[derive(Debug, PartialEq)]
pub(crate) enum Finished {
    /// It has an image.
    Image {
        /// Its record, as JSON.
        record: Vec<u8>,
        /// Its files.
        files: Vec<ParcelFile>,
    },
    /// It has none, for this reason.
    Failed(String),
}

/// The frames of a shard that have not been passed on.
pub(crate) struct Open {
    /// Not assigned to a child.
    waiting: BTreeSet<u64>,
    /// Finished before an older one.
    early: BTreeMap<u64, Finished>,
    early_bytes: usize,
    next: u64,
    end: u64,
    ahead: u64,
}

impl Open {
    pub(crate) fn new(frames: Range<u64>, slots: usize) -> Self {
        Self {
            next: frames.start,
            end: frames.end,
            waiting: frames.collect(),
            early: BTreeMap::new(),
            early_bytes: 0,
            ahead: AHEAD_PER_SLOT * slots as u64,
        }
    }

    pub(crate) fn is_done(&self) -> bool {
        self.next >= self.end
    }

    /// The next frame to be rendered, unless too much waits for an older one.
    pub(crate) fn next(&mut self) -> Option<u64> {
        let &frame = self.waiting.first()?;
        let has_room = frame - self.next < self.ahead && self.early_bytes < MOST_WAITING_BYTES;
        (has_room || frame == self.next).then(|| self.waiting.pop_first())?
    }

    pub(crate) fn take_back(&mut self, frames: &[u64]) {
        self.waiting.extend(frames);
    }

    pub(crate) fn finish(&mut self, message: Message) {
        if let Message::Image { frame, .. } | Message::Failed { frame, .. } = message {
            self.insert(frame, Finished::from(message));
        }
    }

    pub(crate) fn insert(&mut self, frame: u64, finished: Finished) {
        self.early_bytes += finished.bytes();
        self.early.insert(frame, finished);
    }

    pub(crate) fn hand_on(
        &mut self,
        take: &mut impl FnMut(u64, Finished) -> Result<(), SetError>,
    ) -> Result<(), SetError> {
        while let Some(finished) = self.early.remove(&self.next) {
            self.early_bytes -= finished.bytes();
            take(self.next, finished)?;
            self.next += 1;
        }
        Ok(())
    }
}

impl From<Message> for Finished {
    fn from(message: Message) -> Self {
        match message {
            Message::Image { record, files, .. } => Self::Image { record, files },
            Message::Failed { error, .. } => Self::Failed(error),
            Message::Begun { .. } => Self::Failed("it was begun and not finished".to_owned()),
        }
    }
}

impl Finished {
    fn bytes(&self) -> usize {
        match self {
            Self::Image { record, files } => {
                record.len() + files.iter().map(|file| file.bytes.len()).sum::<usize>()
            }
            Self::Failed(error) => error.len(),
        }
    }
}
