//! Taking a job up: checked, stored, then offered to workers. Shared by jobs and direct renders.

use std::sync::Arc;

use crate::leases::table::JobEntry;
use catalogue::{Idempotency, InsertJob, JobRow, NewJob};
use spec::{FieldError, Invalid, Job};
use uuid::Uuid;

use crate::app::{App, Shared};
use crate::http::auth::Caller;
use crate::http::problem::{Problem, Slug};

/// A description on its way to become a job.
pub(crate) struct Submission {
    pub(crate) job: Job,
    pub(crate) priority: i32,
    pub(crate) caller: Caller,
    pub(crate) idempotency_key: Option<String>,
}

/// Stores the job and offers it to workers, or finds the one that the same key made before. Goes on to its end when
/// the client goes away: a stored job that no worker is offered would wait for the next start of the service.
pub(crate) async fn submit(app: &Shared, submission: Submission) -> Result<JobRow, Problem> {
    check(app, &submission.job).await?;
    app.space.room().await?;
    let app = Arc::clone(app);
    let task = tokio::spawn(async move { store(&app, submission).await });
    task.await.map_err(|error| Problem::internal(&error))?
}

/// What a description alone does not tell: whether its scenes and its runtime are there.
pub(crate) async fn check(app: &App, job: &Job) -> Result<(), Problem> {
    check_runtime(app, job)?;
    check_scenes(app, job).await
}

async fn store(app: &App, submission: Submission) -> Result<JobRow, Problem> {
    let Submission {
        job,
        priority,
        caller,
        idempotency_key,
    } = submission;
    let id = format!("job_{}", Uuid::now_v7().simple());
    let digest = job.digest();
    let created_ms = app.clock.unix_ms();
    let idempotency = idempotency_key.map(|key| Idempotency {
        owner: caller.owner,
        key,
        body_digest: digest.clone(),
    });
    let new = NewJob {
        id: id.clone(),
        dataset: job.dataset().to_owned(),
        spec: job.canonical().to_owned(),
        spec_digest: digest,
        frames: job.frames(),
        priority,
        created_ms,
        idempotency,
    };
    faults::point("submit.checked");
    let inserted = app.catalogue.insert_job(new).await?;
    faults::point("submit.inserted");
    let id = match inserted {
        InsertJob::Created => {
            app.dispatch.add_job(
                JobEntry {
                    id: id.clone(),
                    frames: job.frames(),
                    priority,
                    ..JobEntry::default()
                },
                created_ms,
            );
            tracing::info!(
                job = id,
                dataset = job.dataset(),
                frames = job.frames(),
                "job accepted"
            );
            id
        }
        InsertJob::Replayed { job_id } => job_id,
        InsertJob::KeyConflict => {
            let detail = "this Idempotency-Key was used before with another description";
            return Err(Problem::new(Slug::IdempotencyKeyReused, detail));
        }
    };
    let row = app.catalogue.job(&id).await?;
    row.ok_or_else(|| Problem::internal(&format!("job {id} vanished after it was stored")))
}

/// A job with a style that runs on ONNX Runtime only needs a worker that has it.
fn check_runtime(app: &App, job: &Job) -> Result<(), Problem> {
    match &app.style_runtime {
        Err(missing) if needs_runtime(app, job) && !app.dispatch.has_style_runtime() => {
            let hint = "run scripts/get-onnxruntime.sh and restart, or connect a worker that has it";
            Err(Problem::new(Slug::RuntimeMissing, format!("{missing}; {hint}")))
        }
        _ => Ok(()),
    }
}

fn needs_runtime(app: &App, job: &Job) -> bool {
    let styles = job.styles();
    let known = app.styles.known();
    styles.iter().any(|name| known.library.needs_runtime(name))
}

/// Every uploaded scene that a frame can ask for must be there.
async fn check_scenes(app: &App, job: &Job) -> Result<(), Problem> {
    let mut missing = Vec::new();
    for id in job.uploaded_scene_ids() {
        if app.catalogue.scene(&id).await?.is_none() {
            missing.push(FieldError {
                pointer: "/scene/id".to_owned(),
                message: format!("scene `{id}` was not uploaded"),
                value: Some(id.into()),
                limit: None,
                allowed: Vec::new(),
                did_you_mean: None,
            });
        }
    }
    if missing.is_empty() {
        Ok(())
    } else {
        Err(Invalid(missing).into())
    }
}
