//! The jobs of services that share a store: each is a set below it, named by the id of its job.
//!
//! ```text
//! job_0198…/                the set of a job
//! keys/SHA-256              the job that a submission with this key created; created only if absent
//! ```

use serde::{Deserialize, Serialize};

use crate::error::SetError;
use crate::set::job::NewSet;
use crate::set::opened::Set;
use crate::storage::layout;
use crate::storage::location::Location;
use crate::storage::store::Store;

/// How the name of every set of a job begins.
const JOB_PREFIX: &str = "job_";

/// A store with the sets of the jobs of several services.
pub struct JobStore {
    location: Location,
    store: Store,
}

/// What became of a submission.
pub enum Submission {
    /// The set of its job: a new one, or that of the same submission before.
    Set {
        /// The id of the job.
        id: String,
        /// Its set.
        set: Set,
    },
    /// The key was used for another job description.
    KeyConflict,
}

/// The job that a key belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Keyed {
    job: String,
    digest: String,
}

impl JobStore {
    /// Opens a store.
    ///
    /// # Errors
    /// [`SetError`] as [`Store::open`].
    pub fn open(location: &Location) -> Result<Self, SetError> {
        Ok(Self {
            location: location.clone(),
            store: Store::open(location)?,
        })
    }

    /// The location of a job's set.
    #[must_use]
    pub fn location_of(&self, id: &str) -> Location {
        self.location.join(id)
    }

    /// Ids of the jobs that have a folder here, the oldest first.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn ids(&self) -> Result<Vec<String>, SetError> {
        let mut names = self.store.folders()?;
        names.retain(|name| name.starts_with(JOB_PREFIX));
        names.sort_unstable();
        Ok(names)
    }

    /// Begins the set of a job, or finds the one of an earlier submission with this key to any service.
    ///
    /// The key is claimed before the set is begun, so a service that dies in between leaves a key whose repetition begins the
    /// set.
    ///
    /// # Errors
    /// [`SetError`].
    pub fn submit(&self, id: &str, key: Option<&str>, new: &NewSet<'_>) -> Result<Submission, SetError> {
        let mut id = id.to_owned();
        if let Some(key) = key {
            let digest = new.job.digest();
            match self.claim(
                key,
                &Keyed {
                    job: id.clone(),
                    digest: digest.clone(),
                },
            )? {
                Some(first) if first.digest != digest => return Ok(Submission::KeyConflict),
                Some(first) => id = first.job,
                None => {}
            }
        }
        let location = self.location_of(&id);
        let store = Store::open(&location)?;
        let set = match store.get(layout::JOB)? {
            Some(_) => Set::open(&location)?,
            None => Set::begin_in(store, new)?,
        };
        Ok(Submission::Set { id, set })
    }

    /// Claims a key; returns the job that has it already. The key of a deleted job is free again.
    fn claim(&self, key: &str, wanted: &Keyed) -> Result<Option<Keyed>, SetError> {
        let name = format!("{}/{key}", layout::KEYS);
        let text = serde_json::to_vec(wanted)
            .map_err(|error| SetError::Machine(format!("a key cannot be written: {error}")))?;
        let Some(found) = self.store.create(&name, &text)? else {
            return Ok(None);
        };
        let first: Keyed =
            serde_json::from_slice(&found).map_err(|error| SetError::unreadable(&name, error))?;
        let deleted = format!("{}/{}", first.job, layout::DELETED);
        if self.store.get(&deleted)?.is_some() {
            self.store.replace(&name, &text)?;
            return Ok(None);
        }
        Ok(Some(first))
    }
}
