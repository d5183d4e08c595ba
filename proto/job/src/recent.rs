//! Cache of parsed jobs.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::job::Job;

/// Few jobs are active at a time; each takes some kilobytes, at most some megabytes.
const MOST: usize = 16;

/// The most recently used jobs, by a key that identifies the description.
#[derive(Debug, Default)]
pub struct RecentJobs(BTreeMap<String, Arc<Job>>);

impl RecentJobs {
    /// Returns the job of a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<Arc<Job>> {
        self.0.get(key).cloned()
    }

    /// Adds a job; clears the cache if it is full.
    pub fn insert(&mut self, key: &str, job: Arc<Job>) {
        if self.0.len() == MOST {
            self.0.clear();
        }
        self.0.insert(key.to_owned(), job);
    }
}
