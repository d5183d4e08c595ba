//! Selects frames for spot checks: the first frame of each worker and then a random one of each `one_in`,
//! unpredictable for workers. Tracks the commits of each worker since its last good check.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Maximum tracked frames of a worker: some megabytes. Older ones are dropped if checks fall behind.
const MAX_UNPROVEN: usize = 100_000;

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
    has_been_checked: bool,
    is_waiting: bool,
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
        if !unproven.is_waiting && (is_drawn || !unproven.has_been_checked) {
            unproven.is_waiting = true;
            waiting.push_back(Probe {
                worker: worker.to_owned(),
                job,
                frame,
                covers: unproven.frames.len(),
            });
        }
    }

    /// The longest waiting frame.
    pub(crate) fn next(&self) -> Option<Probe> {
        self.state().waiting.pop_front()
    }

    /// The frame is good, and so are its worker's earlier commits.
    pub(crate) fn mark_good(&self, probe: &Probe) {
        self.finish(probe, |unproven| {
            unproven.has_been_checked = true;
            let known = unproven.frames.iter();
            let place = known
                .take(probe.covers)
                .position(|(job, frame)| *job == probe.job && *frame == probe.frame);
            unproven.frames.drain(..place.map_or(0, |place| place + 1));
        });
    }

    /// The check is inconclusive: another frame is selected.
    pub(crate) fn mark_inconclusive(&self, probe: &Probe) {
        self.finish(probe, |_| {});
    }

    fn finish(&self, probe: &Probe, change: impl FnOnce(&mut Unproven)) {
        if let Some(unproven) = self.state().workers.get_mut(&probe.worker) {
            unproven.is_waiting = false;
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
            .retain(|worker, unproven| unproven.is_waiting || is_registered(worker));
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

    #[test]
    fn the_first_frame_of_each_worker_is_checked_and_then_a_random_share() {
        let probes = Probes::new(100);
        commit(&probes, "a", 0..1);
        commit(&probes, "b", 1..2);
        let first = [probes.next(), probes.next()].map(|probe| probe.map(|probe| probe.frame));
        assert_eq!((first, probes.next()), ([Some(0), Some(1)], None));
        let mut checked = 0;
        for frame in 0..20_000 {
            commit(&probes, "c", frame..frame + 1);
            if let Some(probe) = probes.next() {
                probes.mark_good(&probe);
                checked += 1;
            }
        }
        assert!((120..300).contains(&checked), "{checked} of 20000");
        let none = Probes::new(0);
        commit(&none, "a", 0..1000);
        assert_eq!(none.next(), None);
    }

    #[test]
    fn frames_after_the_last_good_one_are_unproven() {
        let probes = Probes::new(1);
        commit(&probes, "a", 0..5);
        let first = probes.next().unwrap();
        assert_eq!((first.frame, probes.next()), (0, None));
        probes.mark_good(&first);
        commit(&probes, "a", 5..7);
        let second = probes.next().unwrap();
        assert_eq!(second.frame, 5);
        probes.mark_inconclusive(&second);
        commit(&probes, "b", 100..101);
        assert_eq!(
            probes.take("a"),
            BTreeMap::from([("job_a".to_owned(), vec![1, 2, 3, 4, 5, 6])])
        );
        assert_eq!(probes.next().map(|probe| probe.worker), Some("b".to_owned()));
        assert!(probes.take("a").is_empty());
    }
}
