//! The simulated service: the lease table, its disk, and an observer of both.

use std::collections::{BTreeMap, BTreeSet};

use api::lease_table::{Grant, JobEntry, LeaseTable, Millis, OpenCost, StrikeEvent, TERM_MS};
use wire::messages::BeatResponse;

/// Bug of the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Variant {
    Sound,
    /// Accepts an image for a frame without one from any worker.
    NoFence,
    /// Accepts an image under a frame's latest token in any state of the frame.
    NoStateGuard,
    /// Offers frames with an image after a restart.
    ForgetsImages,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Violation {
    TwoImages,
    StaleToken,
    LeaseHadEnded,
    WasGivenUp,
    OfferedAgain,
    GivenUpTooSoon,
    Lost,
    Endless,
    TableNotEmpty,
}

pub(crate) type Frame = (String, u64);

/// A claim of a worker.
#[derive(Debug, Clone)]
pub(crate) struct Claim {
    pub(crate) frame: Frame,
    pub(crate) token: u64,
    pub(crate) attempt: u32,
}

impl Claim {
    /// As the lease table takes it.
    pub(crate) fn current(&self) -> wire::messages::Claim {
        crate::claim(&self.frame.0, self.frame.1, self.token, self.attempt)
    }
}

pub(crate) struct Service {
    variant: Variant,
    pub(crate) table: LeaseTable,
    /// Number of restarts: operations of an earlier life are void.
    pub(crate) life: u64,
    token: u64,
    jobs: BTreeMap<String, u64>,
    // On disk:
    images: BTreeMap<Frame, u32>,
    strikes: BTreeMap<Frame, u32>,
    given_up: BTreeSet<Frame>,
    cancelled: BTreeSet<String>,
    paused: BTreeSet<String>,
    // Known only to the observer:
    latest: BTreeMap<Frame, u64>,
    ends: BTreeMap<u64, u64>,
}

impl Service {
    pub(crate) fn new(variant: Variant, jobs: &[(&str, u64)]) -> Self {
        let mut service = Self {
            variant,
            table: LeaseTable::new(),
            life: 0,
            token: 0,
            jobs: jobs
                .iter()
                .map(|(id, frames)| ((*id).to_owned(), *frames))
                .collect(),
            images: BTreeMap::new(),
            strikes: BTreeMap::new(),
            given_up: BTreeSet::new(),
            cancelled: BTreeSet::new(),
            paused: BTreeSet::new(),
            latest: BTreeMap::new(),
            ends: BTreeMap::new(),
        };
        service.restart();
        service
    }

    /// Restarts from the disk.
    pub(crate) fn restart(&mut self) {
        self.life += 1;
        self.table = LeaseTable::new();
        for id in self.jobs.keys().cloned().collect::<Vec<_>>() {
            self.add(&id);
        }
    }

    fn add(&mut self, id: &str) {
        if self.cancelled.contains(id) {
            return;
        }
        let of_job = |frame: &&Frame| frame.0 == id;
        let remembers = self.variant != Variant::ForgetsImages;
        self.table.add_job(JobEntry {
            id: id.to_owned(),
            caller: id.to_owned(),
            frames: self.jobs[id],
            frame_cost: OpenCost::default(),
            priority: i32::from(id == "b"),
            done: self
                .images
                .keys()
                .filter(of_job)
                .filter(|_| remembers)
                .map(|f| f.1..f.1 + 1)
                .collect(),
            failed: self.given_up.iter().filter(of_job).map(|frame| frame.1).collect(),
            strikes: self
                .strikes
                .iter()
                .filter(|(frame, _)| frame.0 == id && !self.images.contains_key(*frame))
                .map(|(frame, &strikes)| (frame.1, strikes))
                .collect(),
            paused: self.paused.contains(id),
            made: None,
            mixed: false,
        });
    }

    pub(crate) fn grant(
        &mut self,
        worker: &str,
        now: u64,
        frame_ms: f64,
    ) -> Result<Option<Grant>, Violation> {
        self.token += 1;
        let Some(grant) = self.table.grant(worker, Millis(now), self.token, frame_ms) else {
            return Ok(None);
        };
        for &(frame, _) in &grant.frames {
            let frame = (grant.job_id.clone(), frame);
            if self.images.contains_key(&frame) || self.given_up.contains(&frame) {
                return Err(Violation::OfferedAgain);
            }
            self.latest.insert(frame, grant.token);
        }
        self.ends.insert(grant.token, now + u64::from(TERM_MS));
        Ok(Some(grant))
    }

    pub(crate) fn beat(&mut self, worker: &str, tokens: &[u64], now: u64) -> BeatResponse {
        let beat = self.table.beat(worker, tokens, Millis(now));
        for token in tokens.iter().filter(|token| !beat.lost.contains(token)) {
            self.ends.insert(*token, now + u64::from(TERM_MS));
        }
        beat
    }

    /// Handles an arriving image; returns whether it is being written.
    pub(crate) fn begin_commit(&mut self, claim: &Claim, now: u64) -> Result<bool, Violation> {
        let Claim { frame, token, .. } = claim;
        let sound = self.table.begin_commit(&claim.current(), Millis(now)).is_ok();
        let latest = self.latest.get(frame) == Some(token);
        let accepted = sound
            || match self.variant {
                Variant::NoFence => !self.images.contains_key(frame),
                Variant::NoStateGuard => latest,
                Variant::Sound | Variant::ForgetsImages => false,
            };
        let violation = if !latest {
            Violation::StaleToken
        } else if self.given_up.contains(frame) {
            Violation::WasGivenUp
        } else if !self.images.contains_key(frame) && self.ends[token] <= now {
            Violation::LeaseHadEnded
        } else {
            return Ok(accepted);
        };
        if accepted { Err(violation) } else { Ok(false) }
    }

    /// The image is on disk.
    pub(crate) fn write(&mut self, frame: &Frame) -> Result<(), Violation> {
        let images = self.images.entry(frame.clone()).or_default();
        *images += 1;
        if *images > 1 {
            Err(Violation::TwoImages)
        } else {
            Ok(())
        }
    }

    pub(crate) fn fail(&mut self, claim: &Claim, retryable: bool, now: u64) -> Result<(), Violation> {
        let Claim { frame, token, .. } = claim;
        let struck = self.table.fail(&claim.current(), retryable, "fault", Millis(now));
        let Ok(event) = struck else { return Ok(()) };
        if self.latest.get(frame) != Some(token) {
            return Err(Violation::StaleToken);
        }
        self.strike(event, retryable)
    }

    pub(crate) fn expire(&mut self, now: u64) -> Result<(), Violation> {
        let events = self.table.expire(Millis(now));
        events.into_iter().try_for_each(|event| self.strike(event, true))
    }

    pub(crate) fn worker_died(&mut self, worker: &str, now: u64) -> Result<(), Violation> {
        let events = self.table.drop_worker(worker, Millis(now));
        events.into_iter().try_for_each(|event| self.strike(event, true))
    }

    fn strike(&mut self, event: StrikeEvent, retryable: bool) -> Result<(), Violation> {
        let frame = (event.job, event.frame);
        self.strikes.insert(frame.clone(), event.strikes);
        if event.quarantined {
            self.strikes.remove(&frame);
            self.given_up.insert(frame);
            if retryable && event.strikes < 3 {
                return Err(Violation::GivenUpTooSoon);
            }
        }
        Ok(())
    }

    pub(crate) fn pause(&mut self, job: &str) {
        self.paused.insert(job.to_owned());
        self.table.pause(job);
    }

    pub(crate) fn resume(&mut self, job: &str) {
        self.paused.remove(job);
        self.table.resume(job);
    }

    pub(crate) fn cancel(&mut self, job: &str) {
        self.cancelled.insert(job.to_owned());
        self.table.cancel(job);
    }

    pub(crate) fn retry(&mut self, job: &str) {
        if self.cancelled.contains(job) {
            return;
        }
        let frames: Vec<u64> = self
            .given_up
            .iter()
            .filter(|frame| frame.0 == job)
            .map(|frame| frame.1)
            .collect();
        self.given_up.retain(|frame| frame.0 != job);
        if !self.table.retry(job, &frames) {
            self.add(job);
        }
    }

    /// Whether every frame has ended; those of a cancelled job have.
    pub(crate) fn is_done(&self) -> bool {
        let open = self.jobs.iter().filter(|(id, _)| !self.cancelled.contains(*id));
        open.flat_map(|(id, &frames)| (0..frames).map(move |frame| (id.clone(), frame)))
            .all(|frame| self.images.contains_key(&frame) || self.given_up.contains(&frame))
    }

    /// Checks the final invariants.
    pub(crate) fn check_end(&self) -> Result<(), Violation> {
        if self.given_up.iter().any(|frame| self.images.contains_key(frame)) {
            return Err(Violation::Lost);
        }
        if self.table.totals() != Default::default() {
            return Err(Violation::TableNotEmpty);
        }
        Ok(())
    }
}
