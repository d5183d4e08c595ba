//! Submission of a job: check, store, offer to workers. Shared by jobs and direct renders.

use std::collections::BTreeMap;
use std::sync::Arc;

use catalogue::{Charge, Idempotency, InsertJob, JobRow, JobState, NewJob};
use spec::{Draft, Job, Uploads};
use tokio::sync::watch::Receiver;

use super::pricing::JobPrice;
use super::{Jobs, new_job_id};
use crate::engine::orders::{Accepted, Order};
use crate::http::extract::Submitter;
use crate::http::problem::{Problem, Slug};
use crate::limits;
use crate::processes::compute::to_the_end;

/// A job with a known state.
pub(super) struct Followed {
    pub(super) row: JobRow,
    /// Its changes since `row`.
    pub(super) changes: Receiver<()>,
}

/// A stored job.
pub(super) struct Submitted {
    pub(super) job: Followed,
    /// Whether all its images already existed, so that nothing was stored.
    pub(super) is_complete: bool,
}

/// Options of a submission.
pub(super) struct Submission {
    pub(super) submitter: Submitter,
    /// Higher values are rendered first among the caller's jobs.
    pub(super) priority: i32,
    /// Whether to render frames that the dataset already has.
    pub(super) again: bool,
}

impl Jobs {
    /// Stores the job and offers it to workers, or finds the job of the same key. Completes even if the client
    /// disconnects: a stored job without an offer would wait for the next start of the service.
    pub(super) async fn submit(
        self: &Arc<Self>,
        job: Job,
        submission: Submission,
    ) -> Result<Submitted, Problem> {
        self.check_runtime(&job)?;
        let price = self.price(&job).await?;
        self.bytes.space.room().await?;
        let jobs = Arc::clone(self);
        to_the_end(async move { jobs.store(&job, submission, price).await }).await
    }

    /// Routes a job to its renderer: the workers of the broker if there is one and they can, else those of this
    /// service.
    pub(super) async fn accept(
        self: &Arc<Self>,
        job: Job,
        submission: Submission,
    ) -> Result<Submitted, Problem> {
        if self.engine.as_ref().is_none_or(|engine| !engine.takes(&job)) {
            return self.submit(job, submission).await;
        }
        let price = self.price(&job).await?;
        self.bytes.space.room().await?;
        let jobs = Arc::clone(self);
        to_the_end(async move { jobs.begin_set(&job, submission, price).await }).await
    }

    /// Creates the set of a job and adds it to the catalogue. The store knows the key, so a repeat finds the job
    /// through every service.
    async fn begin_set(
        &self,
        job: &Job,
        submission: Submission,
        price: JobPrice,
    ) -> Result<Submitted, Problem> {
        let engine = self.engine.as_ref();
        let engine = engine.ok_or_else(|| Problem::internal(&"a set is begun without an engine"))?;
        let mut new = self.row_of(job, submission, price);
        let duplicate = self.catalogue.duplicate(&new).await?;
        if let Some(duplicate) = duplicate.as_ref().filter(|job| job.state == JobState::Done) {
            return Ok(self.submitted(duplicate.clone(), true));
        }
        let _reservation = self.admit(&new, price).await?;
        // The key is also stored here, so that a repeated submission is found before it is refused.
        let key = new.idempotency.as_ref();
        let order = Order {
            id: new.id.clone(),
            job: new.spec.clone(),
            key: key.map(|Idempotency { owner, key, .. }| spec::sha256(format!("{owner}\n{key}").as_bytes())),
        };
        let Accepted::Job { id, location } = engine.submit(&order).await? else {
            return Err(key_conflict());
        };
        (new.id, new.set, new.again) = (id, Some(location), true);
        match self.catalogue.insert_job(new).await? {
            InsertJob::Created(mut row) => {
                let (job, set) = (&row.id, &row.set);
                tracing::info!(job, set, frames = row.frames, "job accepted");
                row.warnings = duplicate.map(|job| job.warnings).unwrap_or_default();
                Ok(self.submitted(row, false))
            }
            InsertJob::Replayed(row) => Ok(self.submitted(row, false)),
            InsertJob::Complete(row) => Ok(self.submitted(row, true)),
            InsertJob::KeyConflict => Err(key_conflict()),
        }
    }

    fn submitted(&self, row: JobRow, is_complete: bool) -> Submitted {
        let mut changes = self.leases.changes.subscribe(&row.id);
        // It may have changed since it was read.
        changes.mark_changed();
        Submitted {
            job: Followed { row, changes },
            is_complete,
        }
    }

    /// Parses a description and checks it, including its scenes.
    pub(super) async fn parse(&self, body: &[u8]) -> Result<Job, Problem> {
        let mut vocabulary = self.vocabulary();
        vocabulary.collections = self.collections_for(body).await?;
        let draft = Draft::read(body, &vocabulary)?;
        let found = self.catalogue.scenes_of(&draft.uploaded_scene_ids()).await?;
        let parts = found.into_iter().map(|row| (row.id, row.files.parts()));
        Ok(draft.check(&Uploads::Known(parts.collect()))?)
    }

    /// All collections, with scenes only for those that the description names.
    async fn collections_for(&self, body: &[u8]) -> Result<BTreeMap<String, Vec<String>>, Problem> {
        let named = Draft::collections_named(body);
        if named.is_empty() {
            return Ok(BTreeMap::new());
        }
        let mut collections = BTreeMap::new();
        for row in self.catalogue.collections().await? {
            let scenes = match named.contains(&row.name) {
                true => self.catalogue.collection(&row.name).await?,
                false => Vec::new(),
            };
            collections.insert(row.name, scenes.into_iter().map(|scene| scene.id).collect());
        }
        Ok(collections)
    }

    /// The unsaved row of a job.
    fn row_of(&self, job: &Job, submission: Submission, price: JobPrice) -> NewJob {
        let spec_digest = job.digest();
        let Submitter {
            owner,
            idempotency_key,
        } = submission.submitter;
        let idempotency = idempotency_key.map(|key| Idempotency {
            owner: owner.clone(),
            key,
            body_digest: spec_digest.clone(),
        });
        NewJob {
            id: new_job_id(),
            dataset: job.dataset().to_owned(),
            spec: job.canonical().to_owned(),
            spec_digest,
            frames: job.frames(),
            // That of a direct render ends with its request.
            priority: limits::JOB_PRIORITY,
            created_at: self.clock.wall(),
            idempotency,
            set: None,
            charge: Some(Charge {
                owner,
                price: price.price,
            }),
            again: submission.again,
        }
    }

    pub(super) async fn store(
        &self,
        job: &Job,
        submission: Submission,
        price: JobPrice,
    ) -> Result<Submitted, Problem> {
        let priority = submission.priority;
        let new = self.row_of(job, submission, price);
        let id = new.id.clone();
        let _reservation = self.admit(&new, price).await?;
        // No scene may be deleted until the row that references it is stored.
        let _turn = self.bytes.naming.beside_others().await;
        if let Some(gone) = self.catalogue.missing_scene(&job.uploaded_scene_ids()).await? {
            let message = format!("scene `{gone}` was deleted while the job was submitted");
            return Err(Problem::field("/scene", message));
        }
        // Before the job can change.
        let changes = self.leases.changes.subscribe(&id);
        faults::point("submit.checked");
        let inserted = self.catalogue.insert_job(new).await?;
        faults::point("submit.inserted");
        match inserted {
            InsertJob::Created(row) => {
                self.leases
                    .dispatch
                    .add_job_with_priority(row.clone().into(), priority);
                let (dataset, frames) = (&row.dataset, row.frames);
                tracing::info!(job = id, dataset, frames, "job accepted");
                Ok(Submitted {
                    job: Followed { row, changes },
                    is_complete: false,
                })
            }
            InsertJob::Complete(row) => Ok(Submitted {
                job: Followed {
                    changes: self.leases.changes.subscribe(&row.id),
                    row,
                },
                is_complete: true,
            }),
            InsertJob::Replayed(row) => {
                let mut changes = self.leases.changes.subscribe(&row.id);
                // It may have changed since it was read.
                changes.mark_changed();
                Ok(Submitted {
                    job: Followed { row, changes },
                    is_complete: false,
                })
            }
            InsertJob::KeyConflict => Err(key_conflict()),
        }
    }

    /// Rejects a model that needs ONNX Runtime if no worker has it.
    pub(super) fn check_runtime(&self, job: &Job) -> Result<(), Problem> {
        let known = self.styles.known();
        let is_needed = job.models().iter().any(|name| known.library.needs_runtime(name));
        match &self.styles.runtime {
            Err(missing) if is_needed && !self.leases.dispatch.has_style_runtime() => {
                let hint = "run scripts/get-onnxruntime.sh and restart, or connect a worker that has it";
                Err(Problem::new(Slug::RuntimeMissing, format!("{missing}; {hint}")))
            }
            _ => Ok(()),
        }
    }
}

fn key_conflict() -> Problem {
    let detail = "this Idempotency-Key was used before with another description";
    Problem::new(Slug::IdempotencyKeyReused, detail)
}

#[cfg(test)]
pub(super) mod tests;
