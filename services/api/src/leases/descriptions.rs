//! The jobs whose frames come in, parsed once rather than for every message.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use catalogue::Catalogue;
use spec::Job;

use crate::http::problem::{Problem, found};

/// Few jobs are worked on at a time; each takes a few kilobytes, at most some megabytes.
const MOST_JOBS: usize = 16;

/// The jobs that were used last, by id.
#[derive(Default)]
pub(crate) struct Descriptions(Mutex<BTreeMap<String, Arc<Job>>>);

impl Descriptions {
    /// The description of a job that is stored.
    pub(crate) async fn get(&self, catalogue: &Catalogue, id: &str) -> Result<Arc<Job>, Problem> {
        if let Some(job) = self.jobs().get(id) {
            return Ok(Arc::clone(job));
        }
        let text = found(catalogue.description(id).await?, "job", id)?;
        let job = Arc::new(Job::trusted(&text).map_err(|error| Problem::internal(&error))?);
        let mut jobs = self.jobs();
        if jobs.len() == MOST_JOBS {
            jobs.clear();
        }
        jobs.insert(id.to_owned(), Arc::clone(&job));
        Ok(job)
    }

    fn jobs(&self) -> MutexGuard<'_, BTreeMap<String, Arc<Job>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
