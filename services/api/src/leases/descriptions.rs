//! The jobs whose frames come in, parsed once rather than for every message.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use catalogue::Catalogue;
use spec::{Job, RecentJobs};

use crate::http::problem::{Problem, found};

/// The jobs that were used last, by id.
#[derive(Default)]
pub(crate) struct Descriptions(Mutex<RecentJobs>);

impl Descriptions {
    /// The description of a job that is stored.
    pub(crate) async fn get(&self, catalogue: &Catalogue, id: &str) -> Result<Arc<Job>, Problem> {
        if let Some(job) = self.jobs().get(id) {
            return Ok(job);
        }
        let text = found(catalogue.description(id).await?, "job", id)?;
        let job = Arc::new(Job::trusted(&text)?);
        self.jobs().insert(id, Arc::clone(&job));
        Ok(job)
    }

    fn jobs(&self) -> MutexGuard<'_, RecentJobs> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
