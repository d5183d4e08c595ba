//! Submission of a job: checked, stored, then offered to workers. Shared by jobs and direct renders.

use std::collections::BTreeMap;
use std::sync::Arc;

use catalogue::{Idempotency, InsertJob, JobRow, JobState, NewJob};
use spec::{Draft, Job, Uploads};
use tokio::sync::watch::Receiver;

use super::{Jobs, new_job_id};
use crate::engine::orders::{Accepted, Order};
use crate::http::extract::Submitter;
use crate::http::problem::{Problem, Slug};
use crate::processes::compute::to_the_end;

/// A job of which one state is known.
pub(super) struct Followed {
    pub(super) row: JobRow,
    /// Its changes since `row`.
    pub(super) changes: Receiver<()>,
}

/// A job that is stored.
pub(super) struct Submitted {
    pub(super) job: Followed,
    /// Whether it had every image of the description already, so that nothing was stored.
    pub(super) is_complete: bool,
}

/// How a description is submitted.
pub(super) struct Submission {
    pub(super) submitter: Submitter,
    /// Higher goes first.
    pub(super) priority: i32,
    /// Whether its frames are rendered although the dataset has every image of it.
    pub(super) again: bool,
}

impl Jobs {
    /// Stores the job and offers it to workers, or finds the one that the same key created before. Completes even if the
    /// client disconnects: a stored job that is not offered would wait for the next start of the service.
    pub(super) async fn submit(
        self: &Arc<Self>,
        job: Job,
        submission: Submission,
    ) -> Result<Submitted, Problem> {
        self.check_runtime(&job)?;
        self.bytes.space.room().await?;
        let jobs = Arc::clone(self);
        to_the_end(async move { jobs.store(&job, submission).await }).await
    }

    /// Has a job rendered by whoever renders jobs here: the workers of the broker, if there is one and they can, else those of
    /// this service.
    pub(super) async fn accept(
        self: &Arc<Self>,
        job: Job,
        submission: Submission,
    ) -> Result<Submitted, Problem> {
        if self.engine.as_ref().is_none_or(|engine| !engine.takes(&job)) {
            return self.submit(job, submission).await;
        }
        self.bytes.space.room().await?;
        let jobs = Arc::clone(self);
        to_the_end(async move { jobs.begin_set(&job, submission).await }).await
    }

    /// Begins the set of a job and shows it. Its store knows the key, so a repeat finds it through every service.
    async fn begin_set(&self, job: &Job, submission: Submission) -> Result<Submitted, Problem> {
        let engine = self.engine.as_ref();
        let engine = engine.ok_or_else(|| Problem::internal(&"a set is begun without an engine"))?;
        let mut new = self.row_of(job, submission);
        let duplicate = self.catalogue.duplicate(&new).await?;
        if let Some(duplicate) = duplicate.as_ref().filter(|job| job.state == JobState::Done) {
            return Ok(self.submitted(duplicate.clone(), true));
        }
        let key = new.idempotency.take();
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

    /// Reads a description and checks it, over the scenes that it names as well.
    pub(super) async fn parse(&self, body: &[u8]) -> Result<Job, Problem> {
        let mut vocabulary = self.vocabulary();
        vocabulary.collections = self.collections_for(body).await?;
        let draft = Draft::read(body, &vocabulary)?;
        let found = self.catalogue.scenes_of(&draft.uploaded_scene_ids()).await?;
        let parts = found.into_iter().map(|row| (row.id, row.files.parts()));
        Ok(draft.check(&Uploads::Known(parts.collect()))?)
    }

    /// All collections, with the scenes of those that the description names.
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

    /// The row of a job, yet to be stored.
    fn row_of(&self, job: &Job, submission: Submission) -> NewJob {
        let spec_digest = job.digest();
        let Submitter {
            owner,
            idempotency_key,
        } = submission.submitter;
        let idempotency = idempotency_key.map(|key| Idempotency {
            owner,
            key,
            body_digest: spec_digest.clone(),
        });
        NewJob {
            id: new_job_id(),
            dataset: job.dataset().to_owned(),
            spec: job.canonical().to_owned(),
            spec_digest,
            frames: job.frames(),
            priority: submission.priority,
            created_at: self.clock.wall(),
            idempotency,
            set: None,
            again: submission.again,
        }
    }

    async fn store(&self, job: &Job, submission: Submission) -> Result<Submitted, Problem> {
        let new = self.row_of(job, submission);
        let id = new.id.clone();
        // From here to the row that names them, no scene is deleted.
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
                self.leases.dispatch.add_job(row.clone().into());
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

    /// Refuses a style that only runs on ONNX Runtime when no worker has it.
    pub(super) fn check_runtime(&self, job: &Job) -> Result<(), Problem> {
        let known = self.styles.known();
        let needed = || job.styles().iter().any(|name| known.library.needs_runtime(name));
        match &self.styles.runtime {
            Err(missing) if needed() && !self.leases.dispatch.has_style_runtime() => {
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
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::app::App;
    use crate::config::{Config, Surroundings};
    use crate::jobs::wait::Until;
    use crate::limits::Limits;

    async fn app(folder: &std::path::Path) -> App {
        let config = Config {
            data: folder.to_owned(),
            listen: "127.0.0.1:0".parse().unwrap(),
            workers: 0,
            slots_per_worker: 1,
            worker_program: "/bin/false".into(),
            hosts: Vec::new(),
            token: None,
            styles: None,
            onnxruntime: None,
            library: style::Library::embedded().unwrap(),
            cluster_program: "/bin/false".into(),
            stores: Vec::new(),
            engine: None,
            buckets: None,
            style_trial: Duration::from_secs(1),
            frame_limit: Duration::from_secs(600),
            mix_workers: false,
            spot_check: 0,
        };
        let surroundings = Surroundings {
            clock: crate::clock::Clock::system(),
            style_runtime: Err("none".to_owned()),
            limits: Limits {
                reserve_bytes: 1 << 16,
                ..Limits::default()
            },
        };
        App::open(&config, &surroundings).await.unwrap().0
    }

    #[tokio::test]
    async fn a_job_is_never_read_again_after_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let jobs = app(folder.path()).await.jobs;
        let text = r#"{"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1},
                       "camera": {"width": 100, "height": 50, "hfov_deg": 80}}"#;
        let submit = || {
            let job = Job::parse(text.as_bytes(), &jobs.vocabulary()).unwrap();
            let submitter = Submitter {
                owner: "me".to_owned(),
                idempotency_key: Some("key".to_owned()),
            };
            let submission = Submission {
                submitter,
                priority: 0,
                again: false,
            };
            jobs.submit(job, submission)
        };
        let reads = jobs.catalogue.reads();
        let stored = submit().await.unwrap().job.row;
        let submitted = submit().await.unwrap().job;
        assert_eq!(submitted.row, stored);
        let paused = jobs.pause(stored.id.clone()).await.unwrap();
        jobs.resume(stored.id.clone()).await.unwrap();
        // Resuming reads the description, which may be of an earlier version.
        let reads = reads + 1;
        let cancelled = jobs.cancel(stored.id.clone()).await.unwrap();
        assert_eq!(jobs.catalogue.reads(), reads, "every change returns its row");
        assert_eq!((stored.version, paused.version), (1, 2));
        let seen = jobs
            .wait_on(submitted, Duration::ZERO, Until::Ended)
            .await
            .unwrap();
        assert_eq!(seen, cancelled, "a change since the submission is noticed");
        assert_eq!(jobs.catalogue.reads(), reads + 1);
    }
}
