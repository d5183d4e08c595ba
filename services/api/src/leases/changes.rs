//! Wakes those who wait for a job to change.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use tokio::sync::Notify;

/// One bell for each job that somebody waits for.
#[derive(Default)]
pub(crate) struct Watch(Mutex<HashMap<String, Weak<Notify>>>);

impl Watch {
    /// The bell of a job. Listen to it before reading the job, then no change between the two is missed.
    pub(crate) fn of(&self, job: &str) -> Arc<Notify> {
        let mut bells = self.bells();
        // Those who waited have gone: there are never more entries than waiting requests, plus one.
        bells.retain(|_, bell| bell.strong_count() > 0);
        if let Some(bell) = bells.get(job).and_then(Weak::upgrade) {
            return bell;
        }
        let bell = Arc::new(Notify::new());
        bells.insert(job.to_owned(), Arc::downgrade(&bell));
        bell
    }

    /// Rings the bell of a job that has changed.
    pub(crate) fn wake(&self, job: &str) {
        let bell = self.bells().get(job).and_then(Weak::upgrade);
        if let Some(bell) = bell {
            bell.notify_waiters();
        }
    }

    fn bells(&self) -> MutexGuard<'_, HashMap<String, Weak<Notify>>> {
        // The map stays whole whatever panicked while it was held.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn only_those_who_wait_for_the_job_are_woken_and_nobody_is_remembered() {
        let watch = Watch::default();
        let (mine, other) = (watch.of("job_a"), watch.of("job_b"));
        let (mut woken, mut asleep) = (Box::pin(mine.notified()), Box::pin(other.notified()));
        woken.as_mut().enable();
        asleep.as_mut().enable();
        watch.wake("job_a");
        woken.await;
        assert!(futures::poll!(asleep.as_mut()).is_pending());
        drop(asleep);
        drop((mine, other));
        drop(watch.of("job_c"));
        assert_eq!(watch.bells().len(), 1);
    }
}
