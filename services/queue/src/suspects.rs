//! Frames that may have killed their worker, among others that it held.

use std::collections::BTreeSet;

use crate::types::Millis;

/// How long one worker is kept from new work to become empty: the longest a lease of it can take to end.
const EMPTY_MS: u64 = 15_000;

/// The suspects, and the worker that is emptied for the next one.
#[derive(Default)]
pub(crate) struct Suspects {
    /// From when on, job, frame.
    waiting: BTreeSet<(Millis, String, u64)>,
    emptied: Option<(String, Millis)>,
}

impl Suspects {
    pub(crate) fn add(&mut self, from: Millis, job: String, frame: u64) {
        self.waiting.insert((from, job, frame));
    }

    /// The suspect that waits longest, if its pause is over.
    pub(crate) fn due(&self, now: Millis) -> Option<(String, u64)> {
        let (from, job, frame) = self.waiting.first()?;
        (*from <= now).then(|| (job.clone(), *frame))
    }

    /// The first suspect has found its worker.
    pub(crate) fn take_first(&mut self) {
        self.waiting.pop_first();
        self.emptied = None;
    }

    /// Whether this worker is the one that is kept empty; if there is none, it is from now on.
    pub(crate) fn empties(&mut self, worker: &str, now: Millis) -> bool {
        match &self.emptied {
            Some((emptied, until)) if *until > now => emptied == worker,
            _ => {
                self.emptied = Some((worker.to_owned(), now.plus(EMPTY_MS)));
                true
            }
        }
    }

    pub(crate) fn forget_job(&mut self, id: &str) {
        self.waiting.retain(|(_, job, _)| job != id);
    }
}
