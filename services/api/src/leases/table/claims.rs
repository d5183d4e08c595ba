//! What the holder of a lease says of a frame: it has its image, or it failed. A stale claim changes nothing.

use super::job::Struck;
use super::types::{Millis, Stale, StrikeEvent};
use super::{LeaseTable, event};

impl LeaseTable {
    /// Whether a claim on a frame is current.
    ///
    /// # Errors
    /// [`Stale`].
    pub fn check(&self, job: &str, frame: u64, token: u64, attempt: u32) -> Result<(), Stale> {
        let lease = self
            .leases
            .get(token)
            .filter(|lease| lease.job == job && !lease.cancelled)
            .ok_or(Stale)?;
        if lease.frames.get(&frame) == Some(&attempt) {
            Ok(())
        } else {
            Err(Stale)
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
        let ended = self.leases.get(token).is_none_or(|lease| lease.ends <= now);
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
        let cancelled = self.leases.get(token).is_none_or(|lease| lease.cancelled);
        self.leases.take_out(token, frame);
        if let Some(entry) = self.jobs.get_mut(job).filter(|_| !cancelled) {
            entry.complete(frame);
            self.forget_finished(job);
        }
    }

    /// The image of a pinned frame could not be written; the lease goes on.
    pub fn abort_commit(&mut self, job: &str, frame: u64) {
        let Some(token) = self.pinned.remove(&(job.to_owned(), frame)) else {
            return;
        };
        if self.leases.get(token).is_some_and(|lease| lease.cancelled) {
            self.leases.take_out(token, frame);
        }
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
        self.leases.take_out(token, frame);
        let entry = self.jobs.get_mut(job).ok_or(Stale)?;
        let Struck { strikes, again } = entry.strike(frame, retryable, now);
        if let Some(until) = again {
            entry.pause(frame, until);
        }
        self.forget_finished(job);
        Ok(event(job, frame, strikes, error.to_owned(), again.is_none()))
    }
}
