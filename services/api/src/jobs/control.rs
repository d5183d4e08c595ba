//! Changing where a job stands: in the catalogue first, then in the lease table. One change at a time, so that both
//! always see them in the same order; each goes on to its end when the client goes away.

use std::sync::Arc;

use crate::leases::table::JobEntry;
use catalogue::{CatalogueError, Deleted, JobRow, JobState};

use crate::app::{App, Shared};
use crate::http::problem::Problem;

/// Stops a job; what is there stays. A job that has ended stays as it is.
pub(crate) async fn cancel(app: &Shared, id: String) -> Result<JobRow, Problem> {
    in_turn(app, |app| async move {
        let row = known(&app, &id).await?;
        if row.state.has_ended() {
            return Ok(row);
        }
        let row = app.catalogue.set_state(&id, JobState::Cancelled).await?;
        app.dispatch.cancel(&id);
        told(&app, &id, "cancelled");
        Ok(row)
    })
    .await
}

/// Offers nothing more of a job for now; frames that workers hold are finished.
pub(crate) async fn pause(app: &Shared, id: String) -> Result<JobRow, Problem> {
    in_turn(app, |app| async move {
        let row = app.catalogue.set_state(&id, JobState::Paused).await?;
        app.dispatch.pause(&id);
        told(&app, &id, "paused");
        Ok(row)
    })
    .await
}

/// Offers a paused job again.
pub(crate) async fn resume(app: &Shared, id: String) -> Result<JobRow, Problem> {
    in_turn(app, |app| async move {
        let row = app.catalogue.set_state(&id, JobState::Running).await?;
        app.dispatch.resume(&id);
        told(&app, &id, "resumed");
        Ok(row)
    })
    .await
}

/// Offers the frames again that were given up.
pub(crate) async fn retry_failed(app: &Shared, id: String) -> Result<JobRow, Problem> {
    in_turn(app, |app| async move {
        let again = app.catalogue.retry_failed(&id).await?;
        if !app.dispatch.retry(&id, &again.frames)
            && let Some(job) = app.catalogue.open_job(&id).await?
        {
            let submitted_ms = job.row.created_ms;
            app.dispatch.add_job(entry(job), submitted_ms);
        }
        told(&app, &id, "tried again");
        Ok(again.job)
    })
    .await
}

/// Deletes a job with its images, whatever it is doing. Their space comes back in the background.
pub(crate) async fn delete_job(app: &Shared, id: String) -> Result<Deleted, Problem> {
    in_turn(app, |app| async move {
        let first = app.catalogue.delete_job(&id).await;
        let deleted = or_with_reserve(&app, first, app.catalogue.delete_job(&id)).await?;
        app.dispatch.cancel(&id);
        told(&app, &id, "deleted");
        app.reclaim.notify_one();
        Ok(deleted)
    })
    .await
}

/// Deletes a dataset with all its jobs, which must have ended.
pub(crate) async fn delete_dataset(app: &Shared, name: String) -> Result<Deleted, Problem> {
    in_turn(app, |app| async move {
        let first = app.catalogue.delete_dataset(&name).await;
        let deleted = or_with_reserve(&app, first, app.catalogue.delete_dataset(&name)).await?;
        tracing::info!(
            dataset = name,
            jobs = deleted.jobs,
            images = deleted.images,
            "dataset deleted"
        );
        app.reclaim.notify_one();
        Ok(deleted)
    })
    .await
}

/// What a deletion answered, or, if the disk is full, what it answers with the reserve.
async fn or_with_reserve(
    app: &App,
    first: Result<Deleted, CatalogueError>,
    again: impl Future<Output = Result<Deleted, CatalogueError>>,
) -> Result<Deleted, CatalogueError> {
    match first {
        Err(CatalogueError::Full { .. }) if app.space.give_reserve() => {
            let deleted = again.await;
            // It lays the reserve aside again when it is done.
            app.reclaim.notify_one();
            deleted
        }
        deleted => deleted,
    }
}

/// A job as the lease table takes it up.
pub(crate) fn entry(job: catalogue::OpenJob) -> JobEntry {
    JobEntry {
        id: job.row.id,
        frames: job.row.frames,
        priority: job.row.priority,
        done: job.done,
        failed: job.failed,
        strikes: job.strikes,
        paused: job.row.state == JobState::Paused,
    }
}

/// A stored job.
pub(crate) async fn known(app: &App, id: &str) -> Result<JobRow, Problem> {
    let row = app.catalogue.job(id).await?;
    row.ok_or_else(|| Problem::not_found(format!("no job `{id}`")))
}

fn told(app: &App, id: &str, what: &str) {
    app.watch.wake(id);
    tracing::info!(job = id, "job {what}");
}

async fn in_turn<T, F>(app: &Shared, change: impl FnOnce(Shared) -> F) -> Result<T, Problem>
where
    T: Send + 'static,
    F: Future<Output = Result<T, Problem>> + Send + 'static,
{
    let change = change(Arc::clone(app));
    let app = Arc::clone(app);
    let task = tokio::spawn(async move {
        let _turn = app.turn.lock().await;
        change.await
    });
    task.await.map_err(|error| Problem::internal(&error))?
}
