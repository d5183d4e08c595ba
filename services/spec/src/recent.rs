//! Jobs that are used again and again, parsed once.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::job::Job;

/// Few jobs are worked on at a time; each takes a few kilobytes, at most some megabytes.
const MOST: usize = 16;

/// The jobs that were used last, each under a key that always means the same description.
#[derive(Debug, Default)]
pub struct RecentJobs(BTreeMap<String, Arc<Job>>);

impl RecentJobs {
    /// The job under a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<Arc<Job>> {
        self.0.get(key).cloned()
    }

    /// Keeps a job; forgets all others once there are too many.
    pub fn insert(&mut self, key: &str, job: Arc<Job>) {
        if self.0.len() == MOST {
            self.0.clear();
        }
        self.0.insert(key.to_owned(), job);
    }
}
