//! Renders frames in child processes: in order, with a poisoned frame kept from its neighbors.
//!
//! One child renders on all slots. When it dies or exceeds a limit, the frames that it was rendering are tried one by one,
//! each alone in a new child; one that fails three times alone has failed, with the last reason.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::error::SetError;
use crate::processes::child::{Child, News, Recipe};
use crate::processes::message::{Message, ParcelFile};

/// How often a frame is tried alone.
const TRIES_ALONE: u32 = 3;
/// Children that end before they begin a frame, one after the other.
const MOST_DEATHS_AT_START: u32 = 3;
/// Frames queued for each slot of a child, so that no slot waits for the supervisor.
const QUEUED_PER_SLOT: usize = 1;
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

/// The processes that render a job.
pub struct Crew {
    recipe: Recipe,
    job: String,
    child: Option<Child>,
}

impl Crew {
    /// A crew without children; the first frame starts one.
    #[must_use]
    pub fn new(recipe: Recipe, job: &spec::Job) -> Self {
        Self {
            recipe,
            job: job.canonical().to_owned(),
            child: None,
        }
    }

    /// Renders frames and passes them on in order. `check` is called several times a second and can stop the work.
    pub(crate) fn render(
        &mut self,
        frames: Range<u64>,
        check: &dyn Fn() -> Result<(), SetError>,
        mut take: impl FnMut(u64, Finished) -> Result<(), SetError>,
    ) -> Result<(), SetError> {
        let result = self.work(frames, check, &mut take);
        if result.is_err() {
            // Frames in its slots are of no use to the next shard.
            self.child = None;
        }
        result
    }

    fn work(
        &mut self,
        frames: Range<u64>,
        check: &dyn Fn() -> Result<(), SetError>,
        take: &mut impl FnMut(u64, Finished) -> Result<(), SetError>,
    ) -> Result<(), SetError> {
        let mut open = Open::new(frames, self.recipe.slots);
        let mut deaths_at_start = 0;
        while !open.is_done() {
            check()?;
            let mut child = match self.child.take() {
                Some(child) => child,
                None => Child::start(&self.recipe, self.recipe.slots, &self.job)?,
            };
            while child.load() < self.recipe.slots * (1 + QUEUED_PER_SLOT)
                && let Some(frame) = open.next()
            {
                child.give(frame);
            }
            match child.next() {
                News::Quiet | News::Message(Message::Begun { .. }) => self.child = Some(child),
                News::Message(Message::Failed {
                    frame,
                    error,
                    retryable: true,
                }) => {
                    self.child = Some(child);
                    open.insert(frame, self.alone(frame, &error, check)?);
                }
                News::Message(message) => {
                    self.child = Some(child);
                    open.finish(message);
                }
                News::Gone(reason) => {
                    let (begun, waiting) = child.split();
                    deaths_at_start = if begun.is_empty() { deaths_at_start + 1 } else { 0 };
                    if deaths_at_start == MOST_DEATHS_AT_START {
                        return Err(never_began(&reason));
                    }
                    open.take_back(&waiting);
                    drop(child);
                    for frame in begun {
                        open.insert(frame, self.alone(frame, &reason, check)?);
                    }
                }
            }
            open.hand_on(take)?;
        }
        Ok(())
    }

    /// Renders a frame in a separate child, with repeated attempts.
    fn alone(
        &self,
        frame: u64,
        reason: &str,
        check: &dyn Fn() -> Result<(), SetError>,
    ) -> Result<Finished, SetError> {
        let mut reason = reason.to_owned();
        for _ in 0..TRIES_ALONE {
            let mut child = Child::start(&self.recipe, 1, &self.job)?;
            child.give(frame);
            reason = loop {
                check()?;
                match child.next() {
                    News::Quiet | News::Message(Message::Begun { .. }) => {}
                    News::Message(Message::Failed {
                        error,
                        retryable: true,
                        ..
                    }) => break error,
                    News::Message(message) => return Ok(Finished::from(message)),
                    News::Gone(reason) if child.split().0.is_empty() => return Err(never_began(&reason)),
                    News::Gone(reason) => break reason,
                }
            };
        }
        Ok(Finished::Failed(format!("{reason}; {TRIES_ALONE} times alone")))
    }
}

/// No frame is at fault: the next shard would end the same way.
fn never_began(reason: &str) -> SetError {
    SetError::Machine(format!("a process that was to render began no frame: {reason}"))
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

/// The frames of a shard that have not been passed on.
struct Open {
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
    fn new(frames: Range<u64>, slots: usize) -> Self {
        Self {
            next: frames.start,
            end: frames.end,
            waiting: frames.collect(),
            early: BTreeMap::new(),
            early_bytes: 0,
            ahead: AHEAD_PER_SLOT * slots as u64,
        }
    }

    fn is_done(&self) -> bool {
        self.next >= self.end
    }

    /// The next frame to be rendered, unless too much waits for an older one.
    fn next(&mut self) -> Option<u64> {
        let &frame = self.waiting.first()?;
        let has_room = frame - self.next < self.ahead && self.early_bytes < MOST_WAITING_BYTES;
        (has_room || frame == self.next).then(|| self.waiting.pop_first())?
    }

    fn take_back(&mut self, frames: &[u64]) {
        self.waiting.extend(frames);
    }

    fn finish(&mut self, message: Message) {
        if let Message::Image { frame, .. } | Message::Failed { frame, .. } = message {
            self.insert(frame, Finished::from(message));
        }
    }

    fn insert(&mut self, frame: u64, finished: Finished) {
        self.early_bytes += finished.bytes();
        self.early.insert(frame, finished);
    }

    fn hand_on(
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
