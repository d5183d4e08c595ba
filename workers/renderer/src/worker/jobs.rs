//! Parsed jobs, so that a description is parsed once and not for every lease.

use std::sync::{Arc, Mutex, PoisonError, RwLock};

use proto::message::Lease;
use spec::{Invalid, Job, Vocabulary};
use style::Library;

/// A service works on few jobs at a time; each takes a few kilobytes, at most some megabytes.
const MOST_JOBS: usize = 16;

/// The jobs that were seen last, the newest at the end.
pub(crate) struct Jobs {
    vocabulary: RwLock<Vocabulary>,
    jobs: Mutex<Vec<(String, Arc<Job>)>>,
}

impl Jobs {
    pub(crate) fn new(library: &Library) -> Self {
        Self {
            vocabulary: RwLock::new(crate::vocabulary(library, false)),
            jobs: Mutex::default(),
        }
    }

    /// Understands jobs with these models from now on.
    pub(crate) fn learn(&self, library: &Library) {
        *self.vocabulary.write().unwrap_or_else(PoisonError::into_inner) = crate::vocabulary(library, false);
    }

    /// The job of a lease.
    pub(crate) fn of(&self, lease: &Lease) -> Result<Arc<Job>, Invalid> {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let seen = jobs
            .iter()
            .position(|(id, job)| *id == lease.job_id && job.canonical() == lease.spec_json);
        let entry = match seen {
            Some(position) => jobs.remove(position),
            None => {
                let vocabulary = self.vocabulary.read().unwrap_or_else(PoisonError::into_inner);
                let job = Job::from_canonical(&lease.spec_json, &vocabulary)?;
                (lease.job_id.clone(), Arc::new(job))
            }
        };
        let job = Arc::clone(&entry.1);
        if jobs.len() == MOST_JOBS {
            jobs.remove(0);
        }
        jobs.push(entry);
        Ok(job)
    }
}
