//! Stores the data read from a set in the catalogue.

use std::collections::BTreeMap;
use std::pin::Pin;
use std::sync::Arc;

use catalogue::{Catalogue, CatalogueError, InsertJob, JobRow, NewImage, NewJob, NewShard, UnixMs};
use futures::future::poll_immediate;
use futures::stream::{FuturesUnordered, StreamExt};
use spec::{Draft, Invalid, Job, Uploads, Vocabulary, is_of_earlier_version};

use super::conformity::SetJob;
use super::feed::{Known, SetHead, SetImage};
use crate::jobs::new_job_id;

/// Why a set is not imported.
#[derive(Debug, thiserror::Error)]
pub enum IntakeError {
    /// Catalogue error.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The images imported from this location belong to another job.
    #[error("{location} was imported as {job}, but now contains another job; delete {job} first")]
    AnotherJob {
        /// Location of the set.
        location: String,
        /// The existing job.
        job: String,
    },
    /// A record of the set that no commit could have stored.
    #[error("frame {frame}: {faults}")]
    Record {
        /// The frame.
        frame: u64,
        /// What is wrong with it.
        faults: String,
    },
    /// The set's job cannot be read here.
    #[error("the job of {location}: {invalid}")]
    Job {
        /// Location of the set.
        location: String,
        /// The errors.
        invalid: Invalid,
    },
}

/// Import of a set into a catalogue.
pub struct Intake<'c> {
    catalogue: &'c Catalogue,
    head: SetHead,
    job: Arc<SetJob>,
    id: String,
    is_there: bool,
}

impl<'c> Intake<'c> {
    /// Compares a set with the catalogue. Nothing is stored yet.
    ///
    /// # Errors
    /// [`IntakeError`].
    pub async fn open(
        catalogue: &'c Catalogue,
        head: SetHead,
        vocabulary: &Vocabulary,
    ) -> Result<Self, IntakeError> {
        let checked = check(&head, vocabulary).and_then(|()| SetJob::read(&head.job));
        let job = checked.map_err(|invalid| IntakeError::Job {
            location: head.location.clone(),
            invalid,
        })?;
        let known = catalogue.job_of_set(&head.location).await?;
        match &known {
            Some(known) if known.spec_digest != spec::sha256(head.job.as_bytes()) => {
                Err(IntakeError::AnotherJob {
                    location: head.location,
                    job: known.id.clone(),
                })
            }
            _ => Ok(Self {
                catalogue,
                head,
                job: Arc::new(job),
                is_there: known.is_some(),
                id: known.map_or_else(new_job_id, |known| known.id),
            }),
        }
    }

    /// Id of the job that the images join.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The job of the set, for [`prepare`].
    #[must_use]
    pub fn job(&self) -> Arc<SetJob> {
        Arc::clone(&self.job)
    }

    /// Sets the id of a job that is not stored yet.
    pub(crate) fn set_id(&mut self, id: &str) {
        id.clone_into(&mut self.id);
    }

    /// Whether that job is stored.
    #[must_use]
    pub fn is_there(&self) -> bool {
        self.is_there
    }

    /// The shards that need not be read again.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn known(&self) -> Result<Known, CatalogueError> {
        let imported = self.catalogue.imported_shards(&self.id).await?;
        Ok(imported
            .into_iter()
            .map(|shard| (shard.frame, shard.changed_ms))
            .collect())
    }

    /// Stores the job unless it exists.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn begin(&mut self, now: UnixMs) -> Result<JobRow, CatalogueError> {
        let new = NewJob {
            id: self.id.clone(),
            dataset: self.head.dataset.clone(),
            spec: self.head.job.clone(),
            spec_digest: spec::sha256(self.head.job.as_bytes()),
            frames: self.head.frames,
            priority: 0,
            created_at: now,
            idempotency: None,
            charge: None,
            set: Some(self.head.location.clone()),
            // Equal images of another set do not count: that set may be removed.
            again: true,
        };
        match self.catalogue.insert_job(new).await? {
            InsertJob::Created(row) | InsertJob::Replayed(row) => {
                self.is_there = true;
                self.id.clone_from(&row.id);
                Ok(row)
            }
            InsertJob::Complete(_) | InsertJob::KeyConflict => Err(CatalogueError::Failed {
                message: "a job without a key has a conflict of keys".to_owned(),
            }),
        }
    }

    /// Begins to store images of the existing job.
    #[must_use]
    pub fn storing(&self) -> Storing<'c> {
        Storing {
            catalogue: self.catalogue,
            job: self.id.clone(),
            running: FuturesUnordered::new(),
            shard: None,
            images: 0,
        }
    }
}

/// Maximum parts stored concurrently. They share a transaction, which writes each changed page once; other writers
/// wait for it, some tenths of a second.
const TOGETHER: usize = 4;

/// A part being stored; returns its number of new images.
type Stored<'c> = Pin<Box<dyn Future<Output = Result<u64, CatalogueError>> + Send + 'c>>;

/// Storage of shard images, several parts at a time.
pub struct Storing<'c> {
    catalogue: &'c Catalogue,
    job: String,
    running: FuturesUnordered<Stored<'c>>,
    /// First frame of the last part's shard.
    shard: Option<u64>,
    /// New images so far.
    images: u64,
}

impl Storing<'_> {
    /// Accepts a part; waits while too many are being stored, and for those of the same shard, whose end must be
    /// stored last.
    ///
    /// # Errors
    /// [`CatalogueError`] of this part or of an earlier one.
    pub async fn store(&mut self, images: Vec<NewImage>, shard: NewShard) -> Result<(), CatalogueError> {
        let goes_on = self.shard.replace(shard.frame) == Some(shard.frame);
        let most = if goes_on { 0 } else { TOGETHER - 1 };
        self.wait(most).await?;
        let (catalogue, job) = (self.catalogue, self.job.clone());
        self.running.push(Box::pin(
            async move { catalogue.import(&job, images, shard).await },
        ));
        // Only polling sends it to the writer.
        if let Some(Some(stored)) = poll_immediate(self.running.next()).await {
            self.images += stored?;
        }
        Ok(())
    }

    /// Waits for all parts; returns the number of new images.
    ///
    /// # Errors
    /// [`CatalogueError`] of one of them.
    pub async fn finish(mut self) -> Result<u64, CatalogueError> {
        self.wait(0).await?;
        Ok(self.images)
    }

    async fn wait(&mut self, most: usize) -> Result<(), CatalogueError> {
        while self.running.len() > most
            && let Some(stored) = self.running.next().await
        {
            self.images += stored?;
        }
        Ok(())
    }
}

/// Checks the records of images and prepares them for [`Storing::store`], on any thread. `id`: the job that they join.
///
/// # Errors
/// [`IntakeError::Record`]; [`CatalogueError::Failed`] for a malformed record.
pub fn prepare(
    catalogue: &Catalogue,
    id: &str,
    job: &SetJob,
    images: Vec<SetImage>,
) -> Result<Vec<NewImage>, IntakeError> {
    let mut prepared = Vec::with_capacity(images.len());
    for image in images {
        job.check(&image.record).map_err(|faults| IntakeError::Record {
            frame: image.record.record().frame,
            faults,
        })?;
        prepared.push(catalogue.imported_image(id, &image.record, image.created_ms, &image.offsets)?);
    }
    Ok(prepared)
}

/// Checks the job of a set. Its frames are rendered, so models and scene files need not be available. The program
/// that rendered a job of version 0.1 has checked it.
fn check(head: &SetHead, vocabulary: &Vocabulary) -> Result<(), Invalid> {
    if is_of_earlier_version(&head.job) {
        return Ok(());
    }
    let mut vocabulary = vocabulary.clone();
    vocabulary.local = true;
    Job::from_canonical(&head.job)?.admit_models(&mut vocabulary);
    let draft = Draft::read(head.job.as_bytes(), &vocabulary)?;
    draft.check(&Uploads::Known(BTreeMap::new())).map(drop)
}
