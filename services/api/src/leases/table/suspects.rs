//! Suspects: frames that may have killed their worker while it held others.

use std::collections::BTreeSet;

use super::types::{Millis, TERM_MS};

/// Earliest time, job, frame.
pub(crate) type Suspect = (Millis, String, u64);

/// The suspects, and the worker that is emptied for the next one.
#[derive(Default)]
pub(crate) struct Suspects {
    waiting: BTreeSet<Suspect>,
    emptied: Option<(String, Millis)>,
}

impl Suspects {
    pub(crate) fn add(&mut self, from: Millis, job: String, frame: u64) {
        self.waiting.insert((from, job, frame));
    }

    /// The longest waiting suspect among those whose pause is over and whose job is not paused.
    pub(crate) fn due(&self, now: Millis, offered: impl Fn(&str) -> bool) -> Option<Suspect> {
        let over = self.waiting.iter().take_while(|(from, ..)| *from <= now);
        over.into_iter().find(|(_, job, _)| offered(job)).cloned()
    }

    /// Removes a suspect that is leased to a worker.
    pub(crate) fn take(&mut self, suspect: &Suspect) {
        self.waiting.remove(suspect);
        self.emptied = None;
    }

    /// Whether this worker is the one kept empty. If there is none, it becomes the one, for the maximum duration of
    /// its leases.
    pub(crate) fn empties(&mut self, worker: &str, now: Millis) -> bool {
        match &self.emptied {
            Some((emptied, until)) if *until > now => emptied == worker,
            _ => {
                self.emptied = Some((worker.to_owned(), now.plus(TERM_MS.into())));
                true
            }
        }
    }

    pub(crate) fn forget_job(&mut self, id: &str) {
        self.waiting.retain(|(_, job, _)| job != id);
    }
}
