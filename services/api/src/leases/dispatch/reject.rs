//! Commits and rejected reports, and the workers that send them.

use wire::messages::{Claim, RegisterRequest};

use super::Dispatch;
use crate::leases::table::{Stale, StrikeEvent, Toolchain};

impl Dispatch {
    /// The worker that holds a lease: its id and registration.
    pub(crate) fn holder(&self, token: u64) -> Option<(String, RegisterRequest)> {
        self.table(|table, _| {
            let (id, about) = table.holder(token)?;
            Some((id.to_owned(), about.clone()))
        })
    }

    /// Pins the frame of a commit while its image is written. If its job needs another toolchain, this does not count
    /// against the worker, and the frame is offered again. Waiting workers are only woken then: each of them looks at every job.
    pub(crate) fn begin_commit(&self, claim: &Claim, toolchain: &Toolchain) -> Result<(), Stale> {
        let begun = self.table(
            |table, now| match table.record_toolchain(&claim.job_id, toolchain) {
                true => table.begin_commit(claim, now),
                false => table.refuse(claim).and(Err(Stale)),
            },
        );
        begun.inspect_err(|_| self.work.notify_waiters())
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

    /// Dismissed workers of the service. They render no more frames until the service restarts.
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
