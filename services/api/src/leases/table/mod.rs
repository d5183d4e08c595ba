//! The lease table: a pure state machine. Time and tokens are arguments, so a test can play any history. Delivery is
//! at least once; a stale token has no effect.
//!
//! **Scheduling.** The least served caller goes first, and among its jobs the highest priority and then the least served
//! one ([`line`]); a new job queues behind waiting ones. A huge job does not starve a later small one, nor do many small
//! ones starve it. A lease holds about a second of work, and less towards the end of a job, so that all slots finish
//! together.
//!
//! **Blame for a crash.** A worker that vanishes loses all its frames, and it renders several at a time. Only a frame
//! that was the worker's single one gets a strike. Frames from leases of several are offered one at a time from then
//! on. Frames that were alone in their lease but not in their worker become suspects: a suspect is only granted to a
//! worker without other leases, and that worker gets no others meanwhile. One worker at a time is kept from new work
//! until it is empty, so that suspects do not wait forever.

mod charges;
mod claims;
mod grants;
mod job;
mod lease;
mod line;
mod loss;
mod suspects;
mod toolchain;
mod types;
mod workers;

use std::collections::{BTreeMap, HashMap};

use wire::messages::{BeatResponse, RegisterRequest};

use self::job::Job;
use self::lease::Leases;
use self::line::Line;
use self::suspects::Suspects;
pub use self::toolchain::Misfits;
pub use self::types::{Grant, JobEntry, Millis, OpenCost, Rules, Stale, StrikeEvent, Toolchain, Totals};
pub use types::TERM_MS;

/// An idle worker without messages for this long is dropped.
const FORGET_AFTER_MS: u64 = 600_000;

/// All leases of a service.
#[derive(Default)]
pub struct LeaseTable {
    pub(crate) jobs: BTreeMap<String, Job>,
    line: Line,
    suspects: Suspects,
    pub(crate) leases: Leases,
    /// Frames whose image is being written, with the token of their lease.
    pub(crate) pinned: HashMap<(String, u64), u64>,
    workers: BTreeMap<String, Worker>,
    rules: Rules,
}

struct Worker {
    about: RegisterRequest,
    seen: Millis,
}

impl LeaseTable {
    /// An empty table.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty table with the given rules.
    #[must_use]
    pub fn with_rules(rules: Rules) -> Self {
        Self {
            rules,
            ..Self::default()
        }
    }

    /// Offers a job's open frames.
    pub fn add_job(&mut self, entry: JobEntry) {
        let job = Job::new(&entry);
        if !job.finished() && !self.jobs.contains_key(&entry.id) {
            self.line.add_job(&entry.caller, &entry.id, entry.priority);
            self.jobs.insert(entry.id.clone(), job);
            self.recount(&entry.id);
        }
    }

    /// Drops a cancelled or deleted job and voids its leases. An image being written still counts.
    pub fn cancel(&mut self, job: &str) {
        self.forget_job(job);
        for token in self.leases.of_job(job) {
            self.drop_open(token);
            if let Some(lease) = self.leases.get_mut(token) {
                lease.cancelled = true;
            }
        }
    }

    /// Changes the priority of a job among those of its caller.
    pub fn set_priority(&mut self, job: &str, priority: i32) {
        if let Some(known) = self.jobs.get(job) {
            self.line.set_priority(&known.caller, job, priority);
        }
    }

    /// Price of a caller's unfinished frames.
    #[must_use]
    pub fn open_cost(&self, caller: &str) -> OpenCost {
        self.line.open(caller)
    }

    /// Stops offering a job; its leases continue.
    pub fn pause(&mut self, job: &str) {
        self.hold_back(job, true);
    }

    /// Offers a paused job again.
    pub fn resume(&mut self, job: &str) {
        self.hold_back(job, false);
    }

    fn hold_back(&mut self, job: &str, back: bool) {
        if let Some(job) = self.jobs.get_mut(job) {
            job.held_back = back;
        }
    }

    /// Offers the quarantined ones of these frames again, one at a time and without their strikes. Returns whether
    /// the table has the job; an ended job must be added again.
    pub fn retry(&mut self, id: &str, frames: &[u64]) -> bool {
        let Some(job) = self.jobs.get_mut(id) else {
            return false;
        };
        frames.iter().for_each(|&frame| job.retry(frame));
        self.recount(id);
        true
    }

    /// Offers frames again that have lost their image, one at a time. Returns whether the table has the job.
    pub fn reopen(&mut self, id: &str, frames: &[u64]) -> bool {
        let Some(job) = self.jobs.get_mut(id) else {
            return false;
        };
        frames.iter().for_each(|&frame| job.reopen(frame));
        self.recount(id);
        true
    }

    /// Extends a worker's leases; returns the cancelled and lost ones.
    pub fn beat(&mut self, worker: &str, tokens: &[u64], now: Millis) -> BeatResponse {
        self.record_message(worker, now);
        let mut beat = BeatResponse::default();
        for &token in tokens {
            match self.leases.get_mut(token).filter(|lease| lease.worker == worker) {
                None => beat.lost.push(token),
                Some(lease) if lease.cancelled => {
                    lease.notified = true;
                    beat.cancelled.push(token);
                    self.leases.remove_if_empty(token);
                }
                Some(lease) => {
                    let last = lease.since.plus(self.rules.frame_limit_ms);
                    self.leases.prolong(token, last.min(now.plus(TERM_MS.into())));
                }
            }
        }
        // Granted while the worker's last heartbeat was on its way.
        for token in self.cancelled_of(worker) {
            if let Some(lease) = self.leases.get_mut(token) {
                lease.notified = true;
            }
            beat.cancelled.push(token);
            self.leases.remove_if_empty(token);
        }
        beat
    }

    /// The cancelled leases of which a worker has not been notified.
    #[must_use]
    pub fn cancelled_of(&self, worker: &str) -> Vec<u64> {
        let tokens = self.leases.tokens_of(worker).into_iter();
        tokens
            .filter(|token: &u64| {
                let lease = self.leases.get(*token);
                lease.is_some_and(|lease| lease.cancelled && !lease.notified)
            })
            .collect()
    }

    /// Takes the open frames of a lease back without counting an attempt.
    pub fn release(&mut self, token: u64, now: Millis) {
        self.charge_time(token, now);
        for (job, frame) in self.drop_open(token) {
            self.refund(token);
            if let Some(job) = self.jobs.get_mut(&job) {
                job.give_back(frame);
            }
        }
        self.leases.remove_if_empty(token);
    }

    /// Whether a job has frames that have not ended.
    #[must_use]
    pub fn has_job(&self, job: &str) -> bool {
        self.jobs.contains_key(job)
    }

    /// Queued and leased frames.
    #[must_use]
    pub fn totals(&self) -> Totals {
        let queued = self.jobs.values().map(Job::queued).sum();
        Totals {
            queued,
            leased: self.jobs.values().map(Job::leased).sum(),
        }
    }

    pub(crate) fn forget_finished(&mut self, job: &str) {
        self.recount(job);
        if self.jobs.get(job).is_some_and(Job::finished) {
            self.forget_job(job);
        }
    }

    fn forget_job(&mut self, id: &str) {
        if let Some(job) = self.jobs.remove(id) {
            self.line.remove_job(&job.caller, id);
            self.suspects.forget_job(id);
        }
    }
}

pub(crate) fn event(job: &str, frame: u64, strikes: u32, error: String, quarantined: bool) -> StrikeEvent {
    StrikeEvent {
        job: job.to_owned(),
        frame,
        strikes,
        error,
        quarantined,
    }
}
