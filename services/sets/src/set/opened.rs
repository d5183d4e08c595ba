//! An open set: its store, its job, its markers.

use spec::{EARLIER_VERSION, Job, SetState};

use crate::error::SetError;
use crate::set::job::{Card, NewSet};
use crate::set::marker::Marker;
use crate::set::state;
use crate::storage::layout::{self, Attempt};
use crate::storage::location::Location;
use crate::storage::store::Store;

/// An open set.
#[derive(Clone)]
pub struct Set {
    pub(crate) store: Store,
    card: Card,
    /// `None`: it is of version 0.1.
    job: Option<Job>,
}

impl Set {
    /// Opens the set at a location to render this job; begins it if the location is empty.
    ///
    /// # Errors
    /// [`SetError::Refused`] for another job, version or division into shards, and for a store that cannot create objects only if
    /// absent; otherwise [`SetError`] of the store.
    pub fn begin(location: &Location, new: &NewSet<'_>) -> Result<Self, SetError> {
        Self::begin_in(Store::open(location)?, new)
    }

    pub(crate) fn begin_in(store: Store, new: &NewSet<'_>) -> Result<Self, SetError> {
        let card = Card::new(new)?;
        probe(&store)?;
        let text = serde_json::to_vec_pretty(&card)
            .map_err(|error| SetError::Machine(format!("job.json cannot be written: {error}")))?;
        let (card, job) = match store.create(layout::JOB, &text)? {
            None => (card, Some(new.job.clone())),
            Some(found) => {
                let (card, job) = Card::read(&found)?;
                card.accept(new, store.location())?;
                (card, job)
            }
        };
        Ok(Self { store, card, job })
    }

    /// Opens the set at a location.
    ///
    /// # Errors
    /// [`SetError::Refused`] without a set; otherwise [`SetError`] of the store.
    pub fn open(location: &Location) -> Result<Self, SetError> {
        if let Location::Folder(path) = location
            && !path.is_dir()
        {
            return Err(SetError::Refused(format!("{location} is not a folder")));
        }
        let store = Store::open(location)?;
        let Some(text) = store.get(layout::JOB)? else {
            return Err(SetError::Refused(format!(
                "{location} holds no set: it has no job.json"
            )));
        };
        let (card, job) = Card::read(&text)?;
        Ok(Self { store, card, job })
    }

    /// The location of the set.
    #[must_use]
    pub fn location(&self) -> &Location {
        self.store.location()
    }

    /// The content of `job.json`.
    #[must_use]
    pub fn card(&self) -> &Card {
        &self.card
    }

    /// The job, to render its frames.
    ///
    /// # Errors
    /// [`SetError::Refused`]: the job is of version 0.1.
    pub fn job(&self) -> Result<&Job, SetError> {
        let job = self.job.as_ref();
        job.ok_or_else(|| SetError::Refused(format!("{}: {EARLIER_VERSION}", self.location())))
    }

    /// The marker of a shard that is done.
    ///
    /// # Errors
    /// [`SetError`] of the store, and a marker that cannot be read.
    pub fn marker(&self, shard: u64) -> Result<Option<Marker>, SetError> {
        let name = layout::done(shard);
        let text = self.store.get(&name)?;
        text.map(|text| Marker::read(&name, &text)).transpose()
    }

    /// Numbers of the shards that are done, sorted.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn done(&self) -> Result<Vec<u64>, SetError> {
        let entries = self.store.list(layout::DONE)?;
        let mut shards: Vec<u64> = entries
            .iter()
            .filter_map(|entry| layout::shard_of(&entry.name))
            .collect();
        shards.sort_unstable();
        Ok(shards)
    }

    /// Whether the set is to be worked on.
    ///
    /// # Errors
    /// [`SetError`] of the store, and a `state.json` that cannot be read.
    pub fn state(&self) -> Result<SetState, SetError> {
        state::read(self.store.get(layout::STATE)?.as_deref())
    }

    /// Changes the state of the set. A cancelled set stays cancelled, even if another process changes it at the same time.
    ///
    /// # Errors
    /// [`SetError::Refused`] for a cancelled set; otherwise [`SetError`] of the store.
    pub fn set_state(&self, state: SetState) -> Result<(), SetError> {
        self.store
            .change(layout::STATE, |found| state::changed(found, state))
    }

    /// Has the shards with failed frames rendered again; returns how many there are.
    ///
    /// # Errors
    /// [`SetError`] of the store, and markers that cannot be read.
    pub fn retry_failed(&self) -> Result<u64, SetError> {
        let mut again = 0;
        for entry in self.store.list(layout::FAILED)? {
            let Some(shard) = layout::shard_of(&entry.name) else {
                continue;
            };
            // The note in `failed/` stays: the next process to render the shard may be writing one.
            if self
                .marker(shard)?
                .is_some_and(|marker| !marker.failed.is_empty())
            {
                self.store.delete(&layout::done(shard))?;
                again += 1;
            }
        }
        Ok(again)
    }

    /// Cancels the set for good and hides it from services; its images stay until the folder is removed.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn retire(&self) -> Result<(), SetError> {
        self.set_state(SetState::Cancelled)?;
        let text = self.store.get(layout::JOB)?.unwrap_or_default();
        self.store.create(layout::DELETED, &text)?;
        self.store.delete(layout::JOB)
    }
}

/// Refuses a store that creates an object although it is there: two attempts could both win.
fn probe(store: &Store) -> Result<(), SetError> {
    let attempt = Attempt::random()?;
    let name = layout::probe(&attempt);
    let refused = store
        .create(&name, b"first")
        .and_then(|_| store.create(&name, b"second"));
    let removed = store.delete(&name);
    match refused? {
        Some(_) => removed,
        None => Err(SetError::Refused(format!(
            "{} overwrites an object that was to be created only if absent (If-None-Match): it cannot hold a set",
            store.location()
        ))),
    }
}
