//! What the rows of large jobs were found to have.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Mutex, PoisonError};

/// Pictures that were measured, and kinds of artifacts.
pub(crate) type Pictures = (BTreeSet<String>, BTreeSet<String>);

/// What jobs of many images were found to have: all of their rows have to be read for it. The version of a job grows with each of its
/// images that is stored or goes.
#[derive(Default)]
pub(crate) struct Remembered(Mutex<HashMap<String, (i64, Pictures)>>);

impl Remembered {
    /// Frames of a job that is remembered; the rows of smaller ones are read in a few milliseconds.
    pub(crate) const LEAST_FRAMES: i64 = 10_000;
    /// Jobs that are remembered.
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
