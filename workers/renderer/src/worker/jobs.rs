//! Jobs by the digest of their description: each is fetched and read once, and not for every lease.

use std::sync::{Arc, Mutex, PoisonError};

use proto::message::Lease;
use spec::Job;

use super::client::ClientError;
use super::held::Hold;
use super::patience::persist;
use super::slot::Refusal;
use super::{Shared, styles};

/// A service works on few jobs at a time; each takes a few kilobytes, at most some megabytes.
const MOST_JOBS: usize = 16;

/// The jobs that were used last, the newest at the end.
#[derive(Default)]
pub(crate) struct Jobs(Mutex<Vec<(String, Arc<Job>)>>);

impl Jobs {
    /// The job of a lease.
    pub(crate) fn get(&self, shared: &Shared, hold: &Hold, lease: &Lease) -> Result<Arc<Job>, Refusal> {
        // Held during the fetch: slots that lease frames of the same job wait for the one that fetches it.
        let mut jobs = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = jobs.iter().position(|(digest, _)| *digest == lease.spec_digest);
        let entry = match kept {
            Some(position) => jobs.remove(position),
            None => {
                let job = read(shared, &fetch(shared, hold, lease)?)?;
                (lease.spec_digest.clone(), Arc::new(job))
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

/// Reads a description, and fetches the styles that it names and this worker lacks. One that the service lacks too fails
/// the frames that use it.
fn read(shared: &Shared, text: &str) -> Result<Job, Refusal> {
    let job = Job::trusted(text).map_err(|invalid| Refusal {
        error: format!("the description cannot be read: {invalid}"),
        retryable: false,
    })?;
    let library = shared.engine.library();
    if job.styles().iter().any(|name| library.get(name).is_none()) {
        styles::learn(shared).map_err(|error| Refusal {
            error: format!("the styles of the job cannot be fetched: {error}"),
            retryable: true,
        })?;
    }
    Ok(job)
}

/// The description that the lease names by its digest.
fn fetch(shared: &Shared, hold: &Hold, lease: &Lease) -> Result<String, Refusal> {
    let Lease {
        job_id, spec_digest, ..
    } = lease;
    let wanted = || !hold.is_lost();
    let fetched = persist(&shared.stop, wanted, || shared.service.description(job_id)).result;
    let text = fetched.map_err(|error| Refusal {
        error: format!("the description of {job_id} cannot be fetched: {error}"),
        retryable: !matches!(error, ClientError::Refused { .. }),
    })?;
    if spec::sha256(&text) != *spec_digest {
        return Err(Refusal {
            error: format!("the description of {job_id} arrived without its digest {spec_digest}"),
            retryable: true,
        });
    }
    String::from_utf8(text).map_err(|_| Refusal {
        error: format!("the description of {job_id} is not UTF-8"),
        retryable: false,
    })
}
