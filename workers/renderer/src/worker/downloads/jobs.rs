//! Jobs by the digest of their description, fetched and parsed once rather than for every lease.

use std::sync::{Arc, PoisonError};

use spec::Job;
use wire::messages::Lease;

use crate::error::RenderError;
use crate::worker::fetch::fetch_bytes;
use crate::worker::held::Hold;
use crate::worker::shared::{Jobs, Shared};
use crate::worker::styles;

impl Jobs {
    /// The job of a lease.
    pub(crate) fn get(&self, shared: &Shared, hold: &Hold, lease: &Lease) -> Result<Arc<Job>, RenderError> {
        // Held during the fetch: slots that lease frames of the same job wait for the one that fetches it.
        let mut jobs = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(job) = jobs.get(&lease.spec_digest) {
            return Ok(job);
        }
        let job = Arc::new(fetch(shared, hold, lease)?);
        jobs.insert(&lease.spec_digest, Arc::clone(&job));
        Ok(job)
    }
}

/// Fetches and parses a description, and fetches the models that this worker lacks. A model that the service lacks as well
/// fails the frames that use it.
fn fetch(shared: &Shared, hold: &Hold, lease: &Lease) -> Result<Job, RenderError> {
    let what = format!("the description of {}", lease.job_id);
    let description = || shared.client.description(&lease.job_id);
    let text = fetch_bytes(shared, hold, &what, &lease.spec_digest, description)?;
    let job = Job::from_canonical(&String::from_utf8_lossy(&text)).map_err(RenderError::Resolve)?;
    let library = shared.engine.library();
    if job.models().iter().any(|name| library.get(name).is_none()) {
        styles::learn(shared).map_err(|error| RenderError::Fetch {
            what: "the models of the job".to_owned(),
            reason: error.to_string(),
            retryable: true,
        })?;
    }
    Ok(job)
}
