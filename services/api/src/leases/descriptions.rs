//! Parsed descriptions of active jobs.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use catalogue::Catalogue;
use spec::{Job, RecentJobs};

use crate::http::problem::{Problem, found};

/// The most recently used jobs, by id.
#[derive(Default)]
pub(crate) struct Descriptions(Mutex<RecentJobs>);

impl Descriptions {
    /// Returns the description of a stored job.
    pub(crate) async fn get(&self, catalogue: &Catalogue, id: &str) -> Result<Arc<Job>, Problem> {
        if let Some(job) = self.jobs().get(id) {
            return Ok(job);
        }
        let text = found(catalogue.description(id).await?, "job", id)?;
        let job = Arc::new(Job::from_canonical(&text)?);
        self.jobs().insert(id, Arc::clone(&job));
        Ok(job)
    }

    fn jobs(&self) -> MutexGuard<'_, RecentJobs> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
