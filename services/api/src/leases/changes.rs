//! Notifies requests that wait for a job to change.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::watch::{Receiver, Sender};

/// A channel for each job with waiting requests.
#[derive(Default)]
pub(crate) struct Changes(Mutex<HashMap<String, Sender<()>>>);

impl Changes {
    /// Follows a job. Changes after this call are not missed.
    pub(crate) fn subscribe(&self, job: &str) -> Receiver<()> {
        let mut senders = self.senders();
        // There are never more entries than waiting requests, plus one.
        senders.retain(|_, sender| sender.receiver_count() > 0);
        senders.entry(job.to_owned()).or_default().subscribe()
    }

    /// Wakes the requests that follow a job.
    pub(crate) fn notify(&self, job: &str) {
        if let Some(sender) = self.senders().get(job) {
            sender.send_replace(());
        }
    }

    fn senders(&self) -> MutexGuard<'_, HashMap<String, Sender<()>>> {
        // The map stays consistent if a holder panics.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn only_followers_of_the_job_are_woken_and_none_is_kept() {
        let changes = Changes::default();
        let (mut mine, other) = (changes.subscribe("job_a"), changes.subscribe("job_b"));
        changes.notify("job_a");
        mine.changed().await.unwrap();
        assert!(!mine.has_changed().unwrap() && !other.has_changed().unwrap());
        drop((mine, other));
        drop(changes.subscribe("job_c"));
        assert_eq!(changes.senders().len(), 1);
    }
}
