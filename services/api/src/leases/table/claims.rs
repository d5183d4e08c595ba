//! Reports of the holder of a lease: an image or a failure. A stale claim has no effect.

use wire::messages::Claim;

use super::job::Struck;
use super::types::{Millis, Stale, StrikeEvent};
use super::{LeaseTable, event};

/// The frame of a claim, as in the table of pinned frames.
fn frame_of(claim: &Claim) -> (String, u64) {
    (claim.job_id.clone(), claim.frame)
}

impl LeaseTable {
    /// Whether a claim on a frame is current.
    ///
    /// # Errors
    /// [`Stale`].
    pub fn check(&self, claim: &Claim) -> Result<(), Stale> {
        let lease = self.leases.get(claim.token).filter(|lease| !lease.cancelled);
        let lease = lease.filter(|lease| lease.job == claim.job_id).ok_or(Stale)?;
        if lease.frames.get(&claim.frame) == Some(&claim.attempt) {
            Ok(())
        } else {
            Err(Stale)
        }
    }

    /// Pins a frame while its image is written, so that it cannot be lost.
    ///
    /// # Errors
    /// [`Stale`], also if the lease has expired by `now` or the frame is already being written.
    pub fn begin_commit(&mut self, claim: &Claim, now: Millis) -> Result<(), Stale> {
        self.check(claim)?;
        let frame = frame_of(claim);
        let lease = self.leases.get(claim.token).ok_or(Stale)?;
        if lease.ends <= now || self.pinned.contains_key(&frame) {
            return Err(Stale);
        }
        let taken = self.charge_time(claim.token, now);
        if let Some(job) = self.jobs.get_mut(&claim.job_id) {
            job.record_time(taken);
        }
        self.pinned.insert(frame, claim.token);
        Ok(())
    }

    /// Whether the image of a frame of a job is being written.
    #[must_use]
    pub fn is_being_written(&self, job: &str) -> bool {
        self.pinned.keys().any(|(other, _)| other == job)
    }

    /// The image of a pinned frame is durable.
    pub fn finish_commit(&mut self, claim: &Claim) {
        let (job, frame) = (&claim.job_id, claim.frame);
        let Some(token) = self.pinned.remove(&frame_of(claim)) else {
            return;
        };
        let cancelled = self.leases.get(token).is_none_or(|lease| lease.cancelled);
        self.refund(token);
        self.leases.take_out(token, frame);
        if let Some(entry) = self.jobs.get_mut(job).filter(|_| !cancelled) {
            entry.complete(frame);
            self.forget_finished(job);
        }
    }

    /// The image of a pinned frame could not be written; the lease continues.
    pub fn abort_commit(&mut self, claim: &Claim) {
        let Some(token) = self.pinned.remove(&frame_of(claim)) else {
            return;
        };
        if self.leases.get(token).is_some_and(|lease| lease.cancelled) {
            self.leases.take_out(token, claim.frame);
        }
    }

    /// Rejects the report on a frame: the frame is offered again without a strike, because its worker is to blame.
    ///
    /// # Errors
    /// [`Stale`].
    pub fn refuse(&mut self, claim: &Claim) -> Result<(), Stale> {
        self.check(claim)?;
        if self.pinned.contains_key(&frame_of(claim)) {
            return Err(Stale);
        }
        self.refund(claim.token);
        self.leases.take_out(claim.token, claim.frame);
        if let Some(job) = self.jobs.get_mut(&claim.job_id) {
            job.give_back(claim.frame);
        }
        Ok(())
    }

    /// An attempt failed.
    ///
    /// # Errors
    /// [`Stale`].
    pub fn fail(
        &mut self,
        claim: &Claim,
        retryable: bool,
        error: &str,
        now: Millis,
    ) -> Result<StrikeEvent, Stale> {
        self.check(claim)?;
        if self.pinned.contains_key(&frame_of(claim)) {
            return Err(Stale);
        }
        let (job, frame) = (&claim.job_id, claim.frame);
        self.charge_time(claim.token, now);
        self.refund(claim.token);
        self.leases.take_out(claim.token, frame);
        let entry = self.jobs.get_mut(job).ok_or(Stale)?;
        let Struck { strikes, again } = entry.strike(frame, retryable, now);
        if let Some(until) = again {
            entry.pause(frame, until);
        }
        self.forget_finished(job);
        Ok(event(job, frame, strikes, error.to_owned(), again.is_none()))
    }
}
