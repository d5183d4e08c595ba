//! Registered workers of the table.

use std::collections::BTreeSet;

use wire::messages::RegisterRequest;

use super::types::Millis;
use super::{LeaseTable, Worker};

impl LeaseTable {
    /// Registers a worker.
    pub fn register(&mut self, worker: &str, about: RegisterRequest, now: Millis) {
        self.workers
            .insert(worker.to_owned(), Worker { about, seen: now });
    }

    /// Removes a worker that committed a wrong frame. Its leased frames return without a strike, because they are not to
    /// blame.
    pub fn dismiss(&mut self, worker: &str, now: Millis) {
        for token in self.leases.tokens_of(worker) {
            self.release(token, now);
        }
        self.workers.remove(worker);
    }

    /// Whether a worker is registered.
    #[must_use]
    pub fn has_worker(&self, worker: &str) -> bool {
        self.workers.contains_key(worker)
    }

    /// Workers with a lease that exceeds the time limit; [`LeaseTable::expire`] would take it back.
    #[must_use]
    pub fn stalled(&self, now: Millis) -> BTreeSet<String> {
        let ended = self.leases.ended(now).into_iter();
        let leases = ended.filter_map(|token| self.leases.get(token));
        let stalled = leases.filter(|lease| self.rules.is_stalled(lease, now));
        stalled.map(|lease| lease.worker.clone()).collect()
    }

    /// The registered workers: id, registration, time of the last message.
    pub fn workers(&self) -> impl Iterator<Item = (&str, &RegisterRequest, Millis)> {
        let workers = self.workers.iter();
        workers.map(|(id, worker)| (id.as_str(), &worker.about, worker.seen))
    }

    /// The worker that holds a lease: its id and registration.
    #[must_use]
    pub fn holder(&self, token: u64) -> Option<(&str, &RegisterRequest)> {
        let id = &self.leases.get(token)?.worker;
        Some((id, &self.workers.get(id)?.about))
    }

    /// Number of frames held by a worker.
    #[must_use]
    pub fn held_by(&self, worker: &str) -> usize {
        let leases = self.leases.of_worker(worker);
        leases.map(|lease| lease.frames.len()).sum()
    }

    /// Records a message of a worker; an unregistered one counts as having one slot.
    pub(super) fn record_message(&mut self, worker: &str, now: Millis) {
        if let Some(known) = self.workers.get_mut(worker) {
            known.seen = now;
        } else {
            let about = RegisterRequest {
                name: worker.to_owned(),
                slots: 1,
                ..RegisterRequest::default()
            };
            self.register(worker, about, now);
        }
    }
}
