//! Selects frames of the service's workers for spot checks: the first frame of each worker and then a random one of each
//! `one_in`. Tracks the commits of each worker since its last good check.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Maximum tracked frames of a worker: some megabytes. Older ones are dropped if checks fall behind.
const MAX_UNPROVEN: usize = 100_000;

/// Maximum frames that a process renders again: a small frame takes less time than its start.
const BATCH: usize = 32;

/// Removes the longest waiting checks of one job from a queue.
pub(super) fn take_batch<C>(waiting: &mut VecDeque<C>, job: fn(&C) -> &str) -> Vec<C> {
    let mut batch: Vec<C> = waiting.pop_front().into_iter().collect();
    while batch.len() < BATCH
        && let Some(next) = waiting.pop_front_if(|next| job(next) == job(&batch[0]))
    {
        batch.push(next);
    }
    batch
}

/// The unchecked frames of all workers.
pub(crate) struct Probes {
    /// One frame of this many is rendered again; 0: none.
    pub(crate) one_in: u64,
    draw: RandomState,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    workers: HashMap<String, Unproven>,
    waiting: VecDeque<Probe>,
}

/// Commits of a worker since its last good check.
#[derive(Default)]
struct Unproven {
    frames: VecDeque<(Arc<str>, u64)>,
    has_been_drawn: bool,
    /// Checks that have not ended.
    waiting: usize,
}

/// A frame to render again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Probe {
    pub(crate) worker: String,
    pub(crate) job: Arc<str>,
    pub(crate) frame: u64,
    /// Number of the worker's frames that it vouches for, including itself.
    covers: usize,
}

impl Probes {
    pub(crate) fn new(one_in: u64) -> Self {
        Self {
            one_in,
            draw: RandomState::new(),
            state: Mutex::default(),
        }
    }

    /// Records a commit of a worker.
    pub(crate) fn record_commit(&self, worker: &str, job: &str, frame: u64) {
        if self.one_in == 0 {
            return;
        }
        let is_drawn = self.draw.hash_one((job, frame)).is_multiple_of(self.one_in);
        let mut state = self.state();
        let State { workers, waiting } = &mut *state;
        if !workers.contains_key(worker) {
            workers.insert(worker.to_owned(), Unproven::default());
        }
        let Some(unproven) = workers.get_mut(worker) else {
            return;
        };
        let job = match unproven.frames.back() {
            Some((last, _)) if **last == *job => Arc::clone(last),
            _ => Arc::from(job),
        };
        if unproven.frames.len() == MAX_UNPROVEN {
            unproven.frames.pop_front();
        }
        unproven.frames.push_back((Arc::clone(&job), frame));
        if is_drawn || !unproven.has_been_drawn {
            unproven.has_been_drawn = true;
            unproven.waiting += 1;
            waiting.push_back(Probe {
                worker: worker.to_owned(),
                job,
                frame,
                covers: unproven.frames.len(),
            });
        }
    }

    /// The longest waiting frames of one job.
    pub(crate) fn next_batch(&self) -> Vec<Probe> {
        take_batch(&mut self.state().waiting, |probe| &probe.job)
    }

    /// The frame is good, and so are its worker's earlier commits.
    pub(crate) fn mark_good(&self, probe: &Probe) {
        self.finish(probe, |unproven| {
            let known = unproven.frames.iter();
            let place = known
                .take(probe.covers)
                .position(|(job, frame)| *job == probe.job && *frame == probe.frame);
            unproven.frames.drain(..place.map_or(0, |place| place + 1));
        });
    }

    /// The check is inconclusive: the worker's frames wait for a later one.
    pub(crate) fn mark_inconclusive(&self, probe: &Probe) {
        self.finish(probe, |_| {});
    }

    fn finish(&self, probe: &Probe, change: impl FnOnce(&mut Unproven)) {
        if let Some(unproven) = self.state().workers.get_mut(&probe.worker) {
            unproven.waiting = unproven.waiting.saturating_sub(1);
            change(unproven);
        }
    }

    /// Removes the unproven frames of a worker and returns them by job.
    pub(crate) fn take(&self, worker: &str) -> BTreeMap<String, Vec<u64>> {
        let mut state = self.state();
        state.waiting.retain(|probe| probe.worker != worker);
        let unproven = state.workers.remove(worker).unwrap_or_default();
        let mut by_job: BTreeMap<String, Vec<u64>> = BTreeMap::new();
        for (job, frame) in unproven.frames {
            by_job.entry(job.to_string()).or_default().push(frame);
        }
        by_job
    }

    /// Drops unregistered workers without unchecked frames.
    pub(crate) fn retain_registered(&self, is_registered: impl Fn(&str) -> bool) {
        self.state()
            .workers
            .retain(|worker, unproven| unproven.waiting > 0 || is_registered(worker));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commit(probes: &Probes, worker: &str, frames: std::ops::Range<u64>) {
        frames.for_each(|frame| probes.record_commit(worker, "job_a", frame));
    }

    fn next(probes: &Probes) -> Option<Probe> {
        let mut batch = probes.next_batch();
        assert!(batch.len() < 2);
        batch.pop()
    }

    #[test]
    fn the_first_frame_of_each_worker_is_checked_and_then_a_random_share() {
        let probes = Probes::new(100);
        commit(&probes, "a", 0..1);
        commit(&probes, "b", 1..2);
        let first: Vec<u64> = probes.next_batch().iter().map(|probe| probe.frame).collect();
        assert_eq!((first.as_slice(), next(&probes)), ([0, 1].as_slice(), None));
        let mut checked = 0;
        for frame in 0..20_000 {
            commit(&probes, "c", frame..frame + 1);
            if let Some(probe) = next(&probes) {
                probes.mark_good(&probe);
                checked += 1;
            }
        }
        assert!((120..300).contains(&checked), "{checked} of 20000");
        let none = Probes::new(0);
        commit(&none, "a", 0..1000);
        assert_eq!(next(&none), None);
    }

    #[test]
    fn the_share_is_met_in_frames_however_long_the_checks_take() {
        let probes = Probes::new(10);
        commit(&probes, "a", 0..10_000);
        let mut waiting = 0;
        while let count @ 1.. = probes.next_batch().len() {
            waiting += count;
        }
        assert!((850..1150).contains(&waiting), "{waiting} of 10000");
    }

    #[test]
    fn frames_after_the_last_good_one_are_unproven() {
        let probes = Probes::new(u64::MAX);
        commit(&probes, "a", 0..5);
        let first = next(&probes).unwrap();
        assert_eq!((first.frame, next(&probes)), (0, None));
        probes.mark_good(&first);
        commit(&probes, "a", 5..7);
        commit(&probes, "b", 100..101);
        assert_eq!(
            probes.take("a"),
            BTreeMap::from([("job_a".to_owned(), vec![1, 2, 3, 4, 5, 6])])
        );
        assert_eq!(next(&probes).map(|probe| probe.worker), Some("b".to_owned()));
        assert!(probes.take("a").is_empty());
    }
}
