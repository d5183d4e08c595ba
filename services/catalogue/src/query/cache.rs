//! Cached summaries of the rows of large jobs.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Mutex, PoisonError};

/// Measured pictures and kinds of artifacts.
pub(crate) type Pictures = (BTreeSet<String>, BTreeSet<String>);

/// The measured pictures and artifact kinds of large jobs, which take a pass over all of their rows. An entry is valid for one
/// version of the job, which grows with each stored or deleted image.
#[derive(Default)]
pub(crate) struct JobCache(Mutex<HashMap<String, (i64, Pictures)>>);

impl JobCache {
    /// Frames from which a job is cached; the rows of smaller ones are read in a few milliseconds.
    pub(crate) const LEAST_FRAMES: i64 = 10_000;
    /// Jobs in the cache.
    const MOST: usize = 1000;

    pub(crate) fn get(&self, job: &str, version: i64) -> Option<Pictures> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (of_version, pictures) = known.get(job)?;
        (*of_version == version).then(|| pictures.clone())
    }

    pub(crate) fn keep(&self, job: String, version: i64, pictures: Pictures) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= Self::MOST {
            known.clear();
        }
        known.insert(job, (version, pictures));
    }
}
