//! The leases, indexed by token, worker and expiry.

use std::collections::{BTreeMap, BTreeSet};

use super::line::Micros;
use super::types::Millis;

pub(crate) struct Lease {
    pub(crate) worker: String,
    pub(crate) job: String,
    pub(crate) caller: String,
    /// Charged for each open frame.
    pub(crate) frame_us: Micros,
    /// Open frames with their attempt.
    pub(crate) frames: BTreeMap<u64, u32>,
    /// Whether it initially had several frames.
    pub(crate) several: bool,
    /// Whether its worker must hold no other lease.
    pub(crate) apart: bool,
    /// Whether its job was cancelled; the lease stays until its worker has been notified.
    pub(crate) cancelled: bool,
    /// Whether its worker has been notified.
    pub(crate) notified: bool,
    /// Time of the grant, or of its latest frame.
    pub(crate) since: Millis,
    pub(crate) ends: Millis,
}

#[derive(Default)]
pub(crate) struct Leases {
    by_token: BTreeMap<u64, Lease>,
    by_worker: BTreeMap<String, BTreeSet<u64>>,
    by_end: BTreeSet<(Millis, u64)>,
}

impl Leases {
    pub(crate) fn insert(&mut self, token: u64, lease: Lease) {
        self.by_worker
            .entry(lease.worker.clone())
            .or_default()
            .insert(token);
        self.by_end.insert((lease.ends, token));
        self.by_token.insert(token, lease);
    }

    pub(crate) fn contains(&self, token: u64) -> bool {
        self.by_token.contains_key(&token)
    }

    pub(crate) fn get(&self, token: u64) -> Option<&Lease> {
        self.by_token.get(&token)
    }

    /// Must not change expiry or worker, which are indexed.
    pub(crate) fn get_mut(&mut self, token: u64) -> Option<&mut Lease> {
        self.by_token.get_mut(&token)
    }

    pub(crate) fn prolong(&mut self, token: u64, ends: Millis) {
        if let Some(lease) = self.by_token.get_mut(&token) {
            self.by_end.remove(&(lease.ends, token));
            lease.ends = ends;
            self.by_end.insert((ends, token));
        }
    }

    /// Tokens of the expired leases.
    pub(crate) fn ended(&self, now: Millis) -> Vec<u64> {
        self.by_end
            .iter()
            .take_while(|(ends, _)| *ends <= now)
            .map(|(_, token)| *token)
            .collect()
    }

    pub(crate) fn tokens_of(&self, worker: &str) -> Vec<u64> {
        self.by_worker
            .get(worker)
            .map(|tokens| tokens.iter().copied().collect())
            .unwrap_or_default()
    }

    pub(crate) fn of_worker(&self, worker: &str) -> impl Iterator<Item = &Lease> {
        let tokens = self.by_worker.get(worker).into_iter().flatten();
        tokens.filter_map(|token| self.by_token.get(token))
    }

    pub(crate) fn of_job(&self, job: &str) -> Vec<u64> {
        self.by_token
            .iter()
            .filter(|(_, lease)| lease.job == job)
            .map(|(token, _)| *token)
            .collect()
    }

    /// Removes a frame from its lease, and the lease with its last frame.
    pub(crate) fn take_out(&mut self, token: u64, frame: u64) {
        if let Some(lease) = self.by_token.get_mut(&token) {
            lease.frames.remove(&frame);
            self.remove_if_empty(token);
        }
    }

    /// Drops a lease without frames.
    pub(crate) fn remove_if_empty(&mut self, token: u64) {
        if self
            .by_token
            .get(&token)
            .is_none_or(|lease| !lease.frames.is_empty())
        {
            return;
        }
        let Some(lease) = self.by_token.remove(&token) else {
            return;
        };
        self.by_end.remove(&(lease.ends, token));
        if let Some(tokens) = self.by_worker.get_mut(&lease.worker) {
            tokens.remove(&token);
            if tokens.is_empty() {
                self.by_worker.remove(&lease.worker);
            }
        }
    }
}
