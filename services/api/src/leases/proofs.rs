//! Which frames of workers outside of the service are rendered again, and the queue of these checks.
//!
//! A frame is drawn by a keyed hash of job and frame. The key is in the catalogue, so the draw is fixed before a frame is
//! leased, survives restarts, and no worker can foresee it. The first frames of every registration are all drawn: a worker
//! that returns under a new name gains nothing. Drawn frames are stored with their image.

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};

use catalogue::{Delivery, DueCheck, JobRow};
use tokio::sync::Notify;

use super::probes::take_batch;

/// First frames of a registration that are all checked.
pub(crate) const PROBATION: u64 = 8;
/// How often frames of a job are drawn after its last one, if the earlier ones could not be rendered again.
const MAX_ROUNDS: u32 = 3;
/// Maximum registrations whose frames are counted; beyond it every frame is drawn.
const MAX_WORKERS: usize = 10_000;

/// Draws and queues checks.
pub(crate) struct Proofs {
    /// One frame of this many is checked; 0: none.
    one_in: u64,
    key: String,
    state: Mutex<State>,
    pub(crate) work: Notify,
}

#[derive(Default)]
struct State {
    /// Frames of each registration.
    commits: HashMap<String, u64>,
    /// Jobs with a wrong frame.
    distrusted: BTreeSet<String>,
    /// Jobs with deliveries that have not ended.
    open: BTreeSet<String>,
    waiting: VecDeque<DueCheck>,
    /// Jobs whose frames have all ended.
    ending: BTreeSet<String>,
    rounds: BTreeMap<String, u32>,
    last_place: u64,
}

impl Proofs {
    pub(crate) fn new(one_in: u64, key: String) -> Self {
        Self {
            one_in,
            key,
            state: Mutex::default(),
            work: Notify::new(),
        }
    }

    /// The delivery of a frame that a worker outside of the service commits; `None`: frames are not checked.
    pub(crate) fn begin_delivery(
        &self,
        worker: &str,
        job: &str,
        frame: u64,
        now_ms: u64,
    ) -> Option<Delivery> {
        if self.one_in == 0 {
            return None;
        }
        let mut state = self.state();
        let is_known = state.commits.contains_key(worker) || state.commits.len() < MAX_WORKERS;
        let count = match is_known {
            true => state.commits.entry(worker.to_owned()).or_default(),
            false => &mut 0,
        };
        *count += 1;
        let is_new = *count <= PROBATION;
        let is_due = is_new || state.distrusted.contains(job) || self.is_drawn(job, frame);
        // The time keeps the order over restarts.
        state.last_place = (state.last_place + 1).max(now_ms << 10);
        state.open.insert(job.to_owned());
        Some(Delivery {
            worker: worker.to_owned(),
            place: state.last_place,
            is_due,
        })
    }

    fn is_drawn(&self, job: &str, frame: u64) -> bool {
        let digest = spec::sha256(format!("{}/{job}/{frame}", self.key).as_bytes());
        let draw = digest
            .get(..16)
            .and_then(|digits| u64::from_str_radix(digits, 16).ok());
        draw.is_none_or(|draw| draw.is_multiple_of(self.one_in))
    }

    /// Continues with open jobs of an earlier run of the service, or with reopened jobs.
    pub(crate) fn resume(&self, jobs: &[JobRow], checks: Vec<DueCheck>) {
        let mut state = self.state();
        for row in jobs {
            if row.unproven > 0 {
                state.open.insert(row.id.clone());
            }
            if row.distrusted {
                state.distrusted.insert(row.id.clone());
            }
            if row.done + row.failed >= row.frames {
                state.ending.insert(row.id.clone());
            }
        }
        state.waiting.extend(checks);
    }

    /// Queues checks.
    pub(crate) fn push(&self, checks: impl IntoIterator<Item = DueCheck>) {
        self.state().waiting.extend(checks);
        self.work.notify_one();
    }

    /// All frames of a job have ended, or a check of it has.
    pub(crate) fn mark_ending(&self, job: &str) {
        let mut state = self.state();
        if state.open.contains(job) {
            state.ending.insert(job.to_owned());
            self.work.notify_one();
        }
    }

    /// Keeps a job whose end could not be stored until the next interval of checks.
    pub(crate) fn keep_ending(&self, job: &str) {
        self.state().ending.insert(job.to_owned());
    }

    /// The longest waiting checks of one job.
    pub(crate) fn next_batch(&self) -> Vec<DueCheck> {
        take_batch(&mut self.state().waiting, |check| &check.job)
    }

    /// The jobs whose frames have all ended, and whether their unproven frames are given up.
    pub(crate) fn take_ending(&self) -> Vec<(String, bool)> {
        let mut state = self.state();
        let ending = std::mem::take(&mut state.ending);
        let rounds = &state.rounds;
        let ending = ending.into_iter().map(|job: String| {
            let is_exhausted = rounds.get(&job).is_some_and(|&rounds| rounds >= MAX_ROUNDS);
            (job, self.one_in == 0 || is_exhausted)
        });
        ending.collect()
    }

    /// Counts a draw after the last frame of a job.
    pub(crate) fn count_round(&self, job: &str) {
        *self.state().rounds.entry(job.to_owned()).or_default() += 1;
    }

    /// A frame of the job was wrong: every later one is checked.
    pub(crate) fn distrust(&self, job: &str) {
        let mut state = self.state();
        state.distrusted.insert(job.to_owned());
        state.rounds.remove(job);
    }

    /// Forgets an ended job.
    pub(crate) fn forget_job(&self, job: &str) {
        let mut state = self.state();
        state.open.remove(job);
        state.distrusted.remove(job);
        state.rounds.remove(job);
    }

    /// Drops the counts of unregistered workers.
    pub(crate) fn retain_registered(&self, is_registered: impl Fn(&str) -> bool) {
        self.state().commits.retain(|worker, _| is_registered(worker));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(job: &str, frame: u64) -> DueCheck {
        DueCheck {
            job: job.to_owned(),
            frame,
            worker: "a".to_owned(),
        }
    }

    fn proofs(key: &str) -> Proofs {
        Proofs::new(50, key.to_owned())
    }

    fn drawn(proofs: &Proofs, worker: &str, frames: std::ops::Range<u64>) -> Vec<u64> {
        frames
            .filter(|&frame| {
                let delivery = proofs.begin_delivery(worker, "job_a", frame, 1);
                delivery.is_some_and(|delivery| delivery.is_due)
            })
            .collect()
    }

    #[test]
    fn the_share_is_met_in_frames_and_the_draw_survives_a_restart() {
        let (before, after, other) = (proofs("k"), proofs("k"), proofs("l"));
        let first = drawn(&before, "a", 0..10_000);
        assert_eq!(first[..PROBATION as usize], [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!((150..260).contains(&first.len()), "{} of 10000", first.len());
        assert_eq!(drawn(&after, "a", 0..10_000), first);
        assert_ne!(drawn(&other, "a", 0..10_000), first);
    }

    #[test]
    fn a_worker_that_returns_under_a_new_name_is_checked_from_its_first_frame() {
        let proofs = proofs("k");
        for visit in 0..30_u64 {
            let frames = visit * 8..visit * 8 + 8;
            let drawn = drawn(&proofs, &format!("wrk_{visit}"), frames.clone());
            assert_eq!(drawn, frames.collect::<Vec<_>>());
        }
    }

    #[test]
    fn every_frame_of_a_distrusted_job_is_drawn_and_without_checks_none() {
        let proofs = proofs("k");
        drawn(&proofs, "a", 0..100);
        proofs.distrust("job_a");
        assert_eq!(drawn(&proofs, "a", 100..200).len(), 100);
        proofs.forget_job("job_a");
        assert!(drawn(&proofs, "a", 200..300).len() < 20);
        let none = Proofs::new(0, String::new());
        assert_eq!(none.begin_delivery("a", "job_a", 0, 0), None);
    }

    #[test]
    fn checks_of_one_job_are_batched_and_places_increase() {
        let proofs = proofs("k");
        proofs.push((0..40).map(|frame| check("job_a", frame)));
        proofs.push([check("job_b", 0)]);
        let sizes = [
            proofs.next_batch().len(),
            proofs.next_batch().len(),
            proofs.next_batch().len(),
        ];
        assert_eq!((sizes, proofs.next_batch().len()), ([32, 8, 1], 0));
        let places = [5, 5, 4, 9].map(|now_ms| {
            let delivery = proofs.begin_delivery("a", "job_a", 0, now_ms);
            delivery.unwrap().place
        });
        assert!(places.is_sorted_by(|a, b| a < b), "{places:?}");
    }
}
