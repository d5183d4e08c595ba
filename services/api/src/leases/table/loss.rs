//! Leases that end without an image: expired, or their worker is gone.

use std::collections::BTreeMap;

use super::job::Struck;
use super::types::{Millis, StrikeEvent};
use super::{FORGET_AFTER_MS, LeaseTable, event};

impl LeaseTable {
    /// Takes back the expired leases, worker by worker.
    pub fn expire(&mut self, now: Millis) -> Vec<StrikeEvent> {
        let mut lost: BTreeMap<String, Vec<u64>> = BTreeMap::new();
        for token in self.leases.ended(now) {
            if let Some(lease) = self.leases.get(token) {
                lost.entry(lease.worker.clone()).or_default().push(token);
            }
        }
        let events = lost
            .into_iter()
            .flat_map(|(worker, tokens)| self.lose(&worker, &tokens, now))
            .collect();
        let leases = &self.leases;
        self.workers.retain(|id, worker| {
            worker.seen.plus(FORGET_AFTER_MS) > now || leases.of_worker(id).next().is_some()
        });
        events
    }

    /// Number of expired leases that [`LeaseTable::expire`] would take back.
    #[must_use]
    pub fn ended(&self, now: Millis) -> usize {
        self.leases.ended(now).len()
    }

    /// The service cannot accept an arrived frame now, which must not count against its worker.
    pub fn excuse(&mut self, token: u64, now: Millis) {
        if let Some(lease) = self.leases.get_mut(token) {
            lease.since = now;
        }
    }

    /// Takes back all leases of a worker whose process has ended.
    pub fn drop_worker(&mut self, worker: &str, now: Millis) -> Vec<StrikeEvent> {
        let tokens = self.leases.tokens_of(worker);
        let events = self.lose(worker, &tokens, now);
        self.workers.remove(worker);
        events
    }

    /// Handles lost leases of a worker; the module documentation explains the consequences for their frames.
    fn lose(&mut self, worker: &str, tokens: &[u64], now: Millis) -> Vec<StrikeEvent> {
        let alone = self.held_by(worker) == 1;
        let known = self.workers.get(worker);
        let name = known.map_or(worker, |known| &known.about.name).to_owned();
        let mut events = Vec::new();
        for &token in tokens {
            let lease = self.leases.get(token);
            let several = lease.is_some_and(|lease| lease.several);
            let is_stalled = lease.is_some_and(|lease| self.rules.is_stalled(lease, now));
            self.charge_time(token, now);
            for (job, frame) in self.drop_open(token) {
                self.refund(token);
                let Some(entry) = self.jobs.get_mut(&job) else {
                    continue;
                };
                if !alone && several {
                    entry.single_out(frame);
                } else if !alone {
                    entry.suspect();
                    self.suspects.add(now, job, frame);
                } else {
                    let Struck { strikes, again } = entry.strike(frame, true, now);
                    // The first failure may be the worker's fault, so retry without a delay.
                    let again = again.map(|pause| if strikes == 1 { now } else { pause });
                    if let Some(from) = again {
                        self.suspects.add(from, job.clone(), frame);
                    }
                    let error = match is_stalled {
                        true => format!(
                            "worker `{name}` held this frame for {} s without an image",
                            self.rules.frame_limit_ms / 1000
                        ),
                        false => {
                            format!("worker `{name}` was lost while it rendered only this frame")
                        }
                    };
                    events.push(event(&job, frame, strikes, error, again.is_none()));
                    self.forget_finished(&job);
                }
            }
            self.leases.remove_if_empty(token);
        }
        events
    }

    /// Removes every unpinned frame from a lease and returns them.
    pub(super) fn drop_open(&mut self, token: u64) -> Vec<(String, u64)> {
        let Some(lease) = self.leases.get_mut(token) else {
            return Vec::new();
        };
        let (job, pinned) = (lease.job.clone(), &self.pinned);
        let mut open = Vec::new();
        lease.frames.retain(|&frame, _| {
            let stays = pinned.get(&(job.clone(), frame)) == Some(&token);
            if !stays {
                open.push((job.clone(), frame));
            }
            stays
        });
        open
    }
}
