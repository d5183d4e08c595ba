//! Workers whose reports were rejected as impossible.

use std::collections::{BTreeMap, BTreeSet};

use wire::messages::{Claim, RegisterRequest};

use super::dispatch::Dispatch;
use super::table::StrikeEvent;

/// A worker is dismissed after this many rejected reports; a single one may be a transmission error.
const MAX_REJECTIONS: u32 = 3;
/// Maximum stored names; they come from workers.
const MAX_NAMES: usize = 1000;

/// Rejected reports and dismissed workers since the service started.
#[derive(Default)]
pub(crate) struct Misbehavior {
    rejections: BTreeMap<String, u32>,
    dismissed: BTreeSet<String>,
    /// Dismissed workers started by the service.
    own: BTreeSet<String>,
}

impl Misbehavior {
    /// Counts a rejected report of a worker; returns whether that dismisses it.
    pub(crate) fn count_rejection(&mut self, id: &str, name: &str, is_own: bool) -> bool {
        let count = self.rejections.entry(id.to_owned()).or_default();
        *count += 1;
        if *count < MAX_REJECTIONS {
            return false;
        }
        self.dismiss(id, name, is_own);
        true
    }

    /// Blocks registrations with this worker's name.
    pub(crate) fn dismiss(&mut self, id: &str, name: &str, is_own: bool) {
        self.rejections.remove(id);
        if self.dismissed.len() < MAX_NAMES {
            self.dismissed.insert(name.to_owned());
        }
        if is_own {
            self.own.insert(name.to_owned());
        }
    }

    /// Whether workers of this name are dismissed.
    pub(crate) fn is_dismissed(&self, name: &str) -> bool {
        self.dismissed.contains(name)
    }

    /// Drops the counts of unregistered workers.
    pub(crate) fn retain_registered(&mut self, is_registered: impl Fn(&str) -> bool) {
        self.rejections.retain(|id, _| is_registered(id));
    }
}

impl Dispatch {
    /// The worker that holds a lease: its id and registration.
    pub(crate) fn holder(&self, token: u64) -> Option<(String, RegisterRequest)> {
        self.table(|table, _| {
            let (id, about) = table.holder(token)?;
            Some((id.to_owned(), about.clone()))
        })
    }

    /// Handles a rejected report: the frame is offered again, and a worker that repeats this is dismissed with all
    /// its leases.
    pub(crate) fn refuse(&self, claim: &Claim, error: &str) -> Vec<StrikeEvent> {
        let mut state = self.state();
        let now = self.now();
        let holder = state.table.holder(claim.token);
        let Some((id, name)) = holder.map(|(id, about)| (id.to_owned(), about.name.clone())) else {
            return Vec::new();
        };
        let Claim { job_id, frame, .. } = claim;
        tracing::warn!(worker = name, job = job_id, frame, error, "a rejected report");
        // An ended lease has already returned the frame.
        let _ = state.table.refuse(claim);
        let events = state.blame(&id, "its reports were rejected", now);
        drop(state);
        self.after_loss(events)
    }

    /// The service's workers that were dismissed. They render no more frames until the service restarts.
    pub(crate) fn dismissed_own(&self) -> Vec<String> {
        self.state().misbehavior.own.iter().cloned().collect()
    }

    /// Whether a worker is registered.
    pub(crate) fn has_worker(&self, id: &str) -> bool {
        self.table(|table, _| table.has_worker(id))
    }

    /// Whether a lease with this token exists.
    pub(crate) fn has_lease(&self, token: u64) -> bool {
        self.table(|table, _| table.holder(token).is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_third_rejection_dismisses_a_worker_and_its_name() {
        let mut misbehavior = Misbehavior::default();
        let refused = |misbehavior: &mut Misbehavior, id, name| misbehavior.count_rejection(id, name, false);
        assert!(!refused(&mut misbehavior, "wrk_1", "a") && !refused(&mut misbehavior, "wrk_1", "a"));
        assert!(!refused(&mut misbehavior, "wrk_2", "b"));
        assert!(!misbehavior.is_dismissed("a"));
        assert!(refused(&mut misbehavior, "wrk_1", "a"));
        assert!(misbehavior.is_dismissed("a") && !misbehavior.is_dismissed("b"));
        misbehavior.retain_registered(|_| false);
        assert!(!refused(&mut misbehavior, "wrk_2", "b"));
    }
}
