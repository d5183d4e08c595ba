//! The lease table.

use std::collections::{BTreeMap, HashMap};

use crate::job::Job;
use crate::types::{Beat, Grant, JobEntry, Millis, Stale, StrikeEvent, Totals, WorkerRow};

/// How long a lease lasts without a beat.
const TERM_MS: u64 = 15_000;
/// Work that one lease should hold: long enough that asking costs nothing, short enough that a lost one costs little.
const LEASE_WORK_MS: f64 = 3000.0;
/// Most frames of a lease, however quick they are.
const MOST_FRAMES: u64 = 256;
/// A worker that holds nothing and was not heard of for so long is forgotten.
const FORGET_AFTER_MS: u64 = 600_000;

/// All leases of a service.
#[derive(Default)]
pub struct LeaseTable {
    jobs: BTreeMap<String, Job>,
    leases: BTreeMap<u64, Lease>,
    pinned: HashMap<(String, u64), u64>,
    workers: BTreeMap<String, Millis>,
    grants: u64,
}

struct Lease {
    worker: String,
    job: String,
    /// Frames that are still open, with their attempt.
    frames: BTreeMap<u64, u32>,
    alone: bool,
    ends: Millis,
}

impl LeaseTable {
    /// An empty table.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Offers a job's open frames.
    pub fn add_job(&mut self, entry: JobEntry) {
        let job = Job::new(&entry);
        if !job.finished() {
            self.jobs.insert(entry.id, job);
        }
    }

    /// Offers nothing more of a job; its leases are void.
    pub fn cancel(&mut self, job: &str) {
        if let Some(job) = self.jobs.get_mut(job) {
            job.cancelled = true;
        }
    }

    /// Takes a worker on.
    pub fn register(&mut self, worker: &str, _name: &str, _slots: u32, now: Millis) {
        self.workers.insert(worker.to_owned(), now);
    }

    /// Leases the next frames to a worker: of the highest priority, the job that waited longest. `frame_ms` is what a frame
    /// costs the worker; not positive: unknown, and one frame is given.
    pub fn grant(&mut self, worker: &str, now: Millis, token: u64, frame_ms: f64) -> Option<Grant> {
        self.workers.insert(worker.to_owned(), now);
        let most = if frame_ms > 0.0 {
            (LEASE_WORK_MS / frame_ms).clamp(1.0, MOST_FRAMES as f64) as u64
        } else {
            1
        };
        let mut order: Vec<(&String, i32, u64)> = self
            .jobs
            .iter()
            .filter(|(_, job)| job.queued() > 0)
            .map(|(id, job)| (id, job.priority, job.served))
            .collect();
        order.sort_by_key(|&(_, priority, served)| (std::cmp::Reverse(priority), served));
        let order: Vec<String> = order.into_iter().map(|(id, ..)| id.clone()).collect();
        for id in order {
            let Some(job) = self.jobs.get_mut(&id) else {
                continue;
            };
            if let Some(frames) = job.take(most, now) {
                self.grants += 1;
                job.served = self.grants;
                let frames: BTreeMap<u64, u32> = frames.map(|frame| (frame, job.attempt(frame))).collect();
                let alone = frames.len() == 1;
                let granted = frames.iter().map(|(&frame, &attempt)| (frame, attempt)).collect();
                let ends = now.plus(TERM_MS);
                self.leases.insert(
                    token,
                    Lease {
                        worker: worker.to_owned(),
                        job: id.clone(),
                        frames,
                        alone,
                        ends,
                    },
                );
                return Some(Grant {
                    token,
                    job_id: id,
                    frames: granted,
                });
            }
        }
        None
    }

    /// Prolongs a worker's leases.
    pub fn beat(&mut self, worker: &str, tokens: &[u64], now: Millis) -> Beat {
        self.workers.insert(worker.to_owned(), now);
        let mut beat = Beat::default();
        for &token in tokens {
            let Some(lease) = self.leases.get_mut(&token).filter(|lease| lease.worker == worker) else {
                beat.lost.push(token);
                continue;
            };
            if self.jobs.get(&lease.job).is_none_or(|job| job.cancelled) {
                beat.cancelled.push(token);
                self.drop_open(token);
            } else {
                lease.ends = now.plus(TERM_MS);
            }
        }
        beat
    }

    /// Whether a claim on a frame is current.
    ///
    /// # Errors
    /// [`Stale`].
    pub fn check(&self, job: &str, frame: u64, token: u64, attempt: u32) -> Result<(), Stale> {
        let lease = self
            .leases
            .get(&token)
            .filter(|lease| lease.job == job)
            .ok_or(Stale)?;
        let cancelled = self.jobs.get(job).is_none_or(|job| job.cancelled);
        if cancelled || lease.frames.get(&frame) != Some(&attempt) {
            Err(Stale)
        } else {
            Ok(())
        }
    }

    /// Pins a frame while its image is written: it cannot be lost meanwhile.
    ///
    /// # Errors
    /// [`Stale`], also when the lease has run out by `now` or the frame is being written already.
    pub fn begin_commit(
        &mut self,
        job: &str,
        frame: u64,
        token: u64,
        attempt: u32,
        now: Millis,
    ) -> Result<(), Stale> {
        self.check(job, frame, token, attempt)?;
        let ended = self.leases.get(&token).is_none_or(|lease| lease.ends <= now);
        let key = (job.to_owned(), frame);
        if ended || self.pinned.contains_key(&key) {
            return Err(Stale);
        }
        self.pinned.insert(key, token);
        Ok(())
    }

    /// The image of a pinned frame is durable.
    pub fn finish_commit(&mut self, job: &str, frame: u64) {
        let Some(token) = self.pinned.remove(&(job.to_owned(), frame)) else {
            return;
        };
        self.take_out(token, frame);
        if let Some(entry) = self.jobs.get_mut(job) {
            entry.complete(frame);
            self.forget_finished(job);
        }
    }

    /// The image of a pinned frame could not be written; the lease goes on.
    pub fn abort_commit(&mut self, job: &str, frame: u64) {
        self.pinned.remove(&(job.to_owned(), frame));
    }

    /// An attempt failed.
    ///
    /// # Errors
    /// [`Stale`].
    #[expect(
        clippy::too_many_arguments,
        reason = "a claim, what happened to it, and the time"
    )]
    pub fn fail(
        &mut self,
        job: &str,
        frame: u64,
        token: u64,
        attempt: u32,
        retryable: bool,
        error: &str,
        now: Millis,
    ) -> Result<StrikeEvent, Stale> {
        self.check(job, frame, token, attempt)?;
        if self.pinned.contains_key(&(job.to_owned(), frame)) {
            return Err(Stale);
        }
        self.take_out(token, frame);
        let event = self.strike(job, frame, retryable, error, now).ok_or(Stale)?;
        self.forget_finished(job);
        Ok(event)
    }

    /// Takes the open frames of a lease back; no attempt is burned.
    pub fn release(&mut self, token: u64, _now: Millis) {
        for (job, frame) in self.drop_open(token) {
            if let Some(job) = self.jobs.get_mut(&job) {
                job.give_back(frame);
            }
        }
    }

    /// Takes back the leases that have run out.
    pub fn expire(&mut self, now: Millis) -> Vec<StrikeEvent> {
        let ended: Vec<u64> = self
            .leases
            .iter()
            .filter(|(_, l)| l.ends <= now)
            .map(|(&token, _)| token)
            .collect();
        let events = ended
            .into_iter()
            .flat_map(|token| self.lose(token, "the lease ran out", now))
            .collect();
        let held: Vec<&str> = self.leases.values().map(|lease| lease.worker.as_str()).collect();
        self.workers
            .retain(|id, seen| held.contains(&id.as_str()) || seen.plus(FORGET_AFTER_MS) > now);
        events
    }

    /// Takes back all leases of a worker whose process has ended.
    pub fn drop_worker(&mut self, worker: &str, now: Millis) -> Vec<StrikeEvent> {
        self.workers.remove(worker);
        let held: Vec<u64> = self
            .leases
            .iter()
            .filter(|(_, l)| l.worker == worker)
            .map(|(&token, _)| token)
            .collect();
        held.into_iter()
            .flat_map(|token| self.lose(token, "the worker process ended", now))
            .collect()
    }

    /// The known workers.
    #[must_use]
    pub fn workers(&self) -> Vec<WorkerRow> {
        let held = |id: &str| {
            let leases = self.leases.values().filter(|lease| lease.worker == id);
            leases.map(|lease| lease.frames.len() as u64).sum()
        };
        let row = |(id, seen): (&String, &Millis)| WorkerRow {
            id: id.clone(),
            leased_frames: held(id),
            last_seen: *seen,
        };
        self.workers.iter().map(row).collect()
    }

    /// Frames that wait and frames that are held.
    #[must_use]
    pub fn totals(&self) -> Totals {
        let queued = self.jobs.values().map(Job::queued).sum();
        Totals {
            queued,
            leased: self.jobs.values().map(|job| job.leased).sum(),
        }
    }

    /// A lost lease: a frame that was alone counts a strike, several are tried one at a time from now on.
    fn lose(&mut self, token: u64, error: &str, now: Millis) -> Vec<StrikeEvent> {
        let alone = self.leases.get(&token).is_some_and(|lease| lease.alone);
        let mut events = Vec::new();
        for (job, frame) in self.drop_open(token) {
            if alone {
                events.extend(self.strike(&job, frame, true, error, now));
            } else if let Some(entry) = self.jobs.get_mut(&job) {
                entry.single_out(frame);
            }
            self.forget_finished(&job);
        }
        events
    }

    fn strike(
        &mut self,
        job: &str,
        frame: u64,
        retryable: bool,
        error: &str,
        now: Millis,
    ) -> Option<StrikeEvent> {
        let (strikes, quarantined) = self.jobs.get_mut(job)?.strike(frame, retryable, now);
        Some(StrikeEvent {
            job: job.to_owned(),
            frame,
            strikes,
            error: error.to_owned(),
            quarantined,
        })
    }

    /// Takes every frame that is not pinned out of a lease and answers them; a lease without frames is gone.
    fn drop_open(&mut self, token: u64) -> Vec<(String, u64)> {
        let Some(lease) = self.leases.get_mut(&token) else {
            return Vec::new();
        };
        let job = lease.job.clone();
        let pinned = &self.pinned;
        let mut open = Vec::new();
        lease.frames.retain(|&frame, _| {
            let stays = pinned.get(&(job.clone(), frame)) == Some(&token);
            if !stays {
                open.push((job.clone(), frame));
            }
            stays
        });
        if lease.frames.is_empty() {
            self.leases.remove(&token);
        }
        open
    }

    fn take_out(&mut self, token: u64, frame: u64) {
        if let Some(lease) = self.leases.get_mut(&token) {
            lease.frames.remove(&frame);
            if lease.frames.is_empty() {
                self.leases.remove(&token);
            }
        }
    }

    fn forget_finished(&mut self, job: &str) {
        if self.jobs.get(job).is_some_and(Job::finished) {
            self.jobs.remove(job);
        }
    }
}
