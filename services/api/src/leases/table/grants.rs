//! Granting leases.

use std::collections::BTreeMap;
use std::ops::Range;

use super::LeaseTable;
use super::job::Job;
use super::lease::Lease;
use super::suspects::Suspect;
use super::types::{Grant, Millis, TERM_MS};

/// Target work of one lease: long enough to make the overhead negligible, short enough to limit the cost of a lost
/// one and the wait of another caller for a slot.
const LEASE_WORK_MS: f64 = 1000.0;
/// Maximum frames of a lease.
const MAX_FRAMES: u64 = 256;

impl LeaseTable {
    /// Leases the next frames to a worker. `token` must be new. `frame_ms` is the worker's recent time per frame, for
    /// jobs without a finished frame; if it is not positive, one frame is granted.
    pub fn grant(&mut self, worker: &str, now: Millis, token: u64, frame_ms: f64) -> Option<Grant> {
        self.record_message(worker, now);
        if self.leases.of_worker(worker).any(|lease| lease.apart) || self.leases.contains(token) {
            return None;
        }
        let about = &self.workers.get(worker)?.about;
        if let Some(suspect) = self.suspects.due(now, |job: &str| {
            let job = self.jobs.get(job);
            job.is_some_and(|job| !job.held_back && self.rules.fits(job, about))
        }) {
            if self.leases.of_worker(worker).next().is_none() {
                return self.grant_suspect(worker, now, token, &suspect);
            }
            if self.suspects.empties(worker, now) {
                return None;
            }
        }
        let alive = self
            .workers
            .values()
            .filter(|worker| worker.seen.plus(TERM_MS.into()) > now);
        let slots: u64 = alive.map(|worker| u64::from(worker.about.slots)).sum();
        let about = &self.workers.get(worker)?.about;
        let (jobs, rules) = (&mut self.jobs, &self.rules);
        let found = self.line.jobs().find_map(|id: &str| {
            let job = jobs.get_mut(id)?;
            if !rules.fits(job, about) {
                return None;
            }
            // The remaining frames are shared among all slots.
            let share = job.queued().div_ceil(slots.max(1));
            let most = frames_worth(job, frame_ms).min(share).max(1);
            Some((id.to_owned(), job.take(most, now)?))
        });
        let (id, frames) = found?;
        Some(self.lease(worker, now, token, &id, frames, false))
    }

    fn grant_suspect(&mut self, worker: &str, now: Millis, token: u64, suspect: &Suspect) -> Option<Grant> {
        self.suspects.take(suspect);
        let (_, job, frame) = suspect;
        let frames = self.jobs.get_mut(job)?.take_suspect(*frame);
        Some(self.lease(worker, now, token, job, frames, true))
    }

    fn lease(
        &mut self,
        worker: &str,
        now: Millis,
        token: u64,
        id: &str,
        frames: Range<u64>,
        apart: bool,
    ) -> Grant {
        let job = self.jobs.get(id).expect("the frames were taken from it");
        let price = job.frame_cost.times(frames.end - frames.start).us;
        self.line.charge_grant(&job.caller, id, price);
        let frames: BTreeMap<u64, u32> = frames.map(|frame| (frame, job.attempt(frame))).collect();
        let granted = frames.iter().map(|(&frame, &attempt)| (frame, attempt)).collect();
        let lease = Lease {
            worker: worker.to_owned(),
            job: id.to_owned(),
            caller: job.caller.clone(),
            frame_us: job.frame_cost.us,
            several: frames.len() > 1,
            frames,
            apart,
            cancelled: false,
            notified: false,
            since: now,
            ends: now.plus(TERM_MS.into()),
        };
        self.leases.insert(token, lease);
        Grant {
            token,
            job_id: id.to_owned(),
            frames: granted,
        }
    }
}

/// Number of frames of a job in a lease of a worker with this time per frame.
fn frames_worth(job: &Job, frame_ms: f64) -> u64 {
    if frame_ms > 0.0 {
        (LEASE_WORK_MS / job.expected_ms(frame_ms)).clamp(1.0, MAX_FRAMES as f64) as u64
    } else {
        1
    }
}
