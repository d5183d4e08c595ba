//! Changes of a job's state: first in the catalogue, then in the lease table. A lock keeps both in the same order.
//! Each change completes even if the client disconnects.

use std::sync::Arc;

use catalogue::{CatalogueError, Deleted, JobRow, JobState};
use spec::SetState;

use super::Jobs;
use crate::engine::Engine;
use crate::http::problem::{Problem, Slug};
use crate::limits;
use crate::processes::compute::to_the_end;

impl Jobs {
    /// Cancels a job; finished images are kept. A job that has ended is unchanged.
    pub(crate) async fn cancel(self: &Arc<Self>, id: String) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            let row = jobs.set_state(&id, SetState::Cancelled).await?;
            if row.state == JobState::Cancelled {
                jobs.leases.dispatch.cancel(&id);
                jobs.leases.proofs.mark_ending(&id);
                jobs.notify(&id, "cancelled");
            }
            Ok(row)
        })
        .await
    }

    /// Stops offering a job's frames; leased frames are finished.
    pub(crate) async fn pause(self: &Arc<Self>, id: String) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            let row = jobs.set_state(&id, SetState::Paused).await?;
            jobs.leases.dispatch.table(|table, _| table.pause(&id));
            jobs.notify(&id, "paused");
            Ok(row)
        })
        .await
    }

    /// Offers the frames of a paused job again.
    pub(crate) async fn resume(self: &Arc<Self>, id: String) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            jobs.check_version(&id).await?;
            let row = jobs.set_state(&id, SetState::Running).await?;
            jobs.leases.dispatch.free(|table, _| table.resume(&id));
            jobs.notify(&id, "resumed");
            Ok(row)
        })
        .await
    }

    /// Changes the state in the catalogue. For a shared job the set changes first; all services follow it.
    async fn set_state(&self, id: &str, state: SetState) -> Result<JobRow, Problem> {
        let wanted = match state {
            SetState::Running => JobState::Running,
            SetState::Paused => JobState::Paused,
            SetState::Cancelled => JobState::Cancelled,
        };
        let Some((engine, row)) = self.shared(id).await? else {
            return Ok(self.catalogue.set_state(id, wanted).await?);
        };
        if !row.state.has_ended() {
            engine.change(&row, state).await?;
        }
        Ok(self.catalogue.set_shared_state(id, wanted).await?)
    }

    /// A shared job and its engine.
    async fn shared(&self, id: &str) -> Result<Option<(&Engine, JobRow)>, Problem> {
        let Some(engine) = &self.engine else {
            return Ok(None);
        };
        let row = self.get(id).await?;
        Ok(row.is_shared().then_some((engine, row)))
    }

    /// Offers the quarantined frames again.
    pub(crate) async fn retry_failed(self: &Arc<Self>, id: String) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            jobs.check_version(&id).await?;
            if let Some((engine, row)) = jobs.shared(&id).await? {
                if !matches!(row.state, JobState::Cancelled | JobState::Done) {
                    engine.retry(&row).await?;
                }
                let row = jobs.catalogue.retry_shared(&id).await?;
                jobs.notify(&id, "tried again");
                return Ok(row);
            }
            let again = jobs.catalogue.retry_failed(&id).await?;
            // The lease table has dropped the ended job.
            let dispatch = &jobs.leases.dispatch;
            let known = dispatch.free(|table, _| table.retry(&id, &again.frames));
            if !known && !again.job.state.has_ended() {
                jobs.offer_again(&again.job).await?;
            }
            jobs.notify(&id, "tried again");
            Ok(again.job)
        })
        .await
    }

    /// Offers the frames of a job that the lease table has dropped.
    pub(super) async fn offer_again(&self, job: &JobRow) -> Result<(), Problem> {
        if self.catalogue.restarting_jobs().await?.contains(&job.id) {
            return Ok(());
        }
        // With unproven frames it ends only through a settlement.
        self.leases.proofs.resume(std::slice::from_ref(job), Vec::new());
        let open = self.catalogue.open_job(job.clone()).await?;
        self.leases.dispatch.add_job(open);
        Ok(())
    }

    /// Deletes the images of some frames, which are then rendered again.
    pub(super) async fn reopen(self: &Arc<Self>, id: String, frames: Vec<u64>) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            jobs.check_version(&id).await?;
            let again = jobs.catalogue.reopen(&id, frames).await?;
            let dispatch = &jobs.leases.dispatch;
            let is_known = dispatch.free(|table, _| table.reopen(&id, &again.frames));
            if !is_known && !again.job.state.has_ended() {
                jobs.offer_again(&again.job).await?;
            }
            jobs.bytes.reclaim.notify_one();
            jobs.notify(&id, "opened again");
            Ok(again.job)
        })
        .await
    }

    /// Deletes a job with its images in any state. Space is reclaimed in the background.
    pub(crate) async fn delete(self: &Arc<Self>, id: String) -> Result<Deleted, Problem> {
        self.in_turn(|jobs| async move {
            let shared = jobs.shared(&id).await?;
            let deleted = jobs.with_reserve(|| jobs.catalogue.delete_job(&id)).await?;
            // Only after the deletion succeeded: a rejected deletion must not hide the job.
            if let Some((engine, row)) = shared {
                engine.retire(&row).await?;
            }
            jobs.leases.dispatch.cancel(&id);
            jobs.leases.proofs.forget_job(&id);
            jobs.notify(&id, "deleted");
            Ok(deleted)
        })
        .await
    }

    /// Deletes a dataset with all its jobs, which must have ended.
    pub(crate) async fn delete_dataset(self: &Arc<Self>, name: String) -> Result<Deleted, Problem> {
        self.in_turn(|jobs| async move {
            let shared = jobs.shared_in(&name).await?;
            let deleted = jobs.with_reserve(|| jobs.catalogue.delete_dataset(&name)).await?;
            // Only after the deletion succeeded: a rejected deletion must not hide the jobs.
            for (engine, row) in shared {
                engine.retire(&row).await?;
            }
            let Deleted { jobs, images, .. } = deleted;
            tracing::info!(dataset = name, jobs, images, "dataset deleted");
            Ok(deleted)
        })
        .await
    }

    /// The shared jobs of a dataset, each with its engine.
    async fn shared_in(&self, dataset: &str) -> Result<Vec<(&Engine, JobRow)>, Problem> {
        let Some(engine) = &self.engine else {
            return Ok(Vec::new());
        };
        let (mut shared, mut cursor) = (Vec::new(), None);
        loop {
            let name = Some(dataset.to_owned());
            let page = self
                .catalogue
                .jobs(name, None, limits::MAX_PAGE_ROWS, cursor)
                .await?;
            if let Some(what) = page.damaged.first() {
                let detail = format!("{what} is damaged: restore a backup, or run `fathom scrub`");
                return Err(Problem::new(Slug::CorruptArtifact, detail));
            }
            let found = page.items.into_iter().filter(JobRow::is_shared);
            shared.extend(found.map(|row| (engine, row)));
            cursor = page.next_cursor;
            if cursor.is_none() {
                return Ok(shared);
            }
        }
    }

    /// Deletes; on a full disk it uses the reserve, which reclaiming restores.
    async fn with_reserve<F>(&self, delete: impl Fn() -> F) -> Result<Deleted, CatalogueError>
    where
        F: Future<Output = Result<Deleted, CatalogueError>>,
    {
        let mut deleted = delete().await;
        let full = matches!(deleted, Err(CatalogueError::Full { .. }));
        let given = full && self.bytes.space.give_reserve();
        if given {
            deleted = delete().await;
        }
        if given || deleted.is_ok() {
            self.bytes.reclaim.notify_one();
        }
        deleted
    }

    pub(super) fn notify(&self, id: &str, what: &str) {
        self.leases.changes.notify(id);
        tracing::info!(job = id, "job {what}");
    }

    pub(super) async fn in_turn<T, F>(
        self: &Arc<Self>,
        change: impl FnOnce(Arc<Self>) -> F + Send + 'static,
    ) -> Result<T, Problem>
    where
        T: Send + 'static,
        F: Future<Output = Result<T, Problem>> + Send + 'static,
    {
        let jobs = Arc::clone(self);
        to_the_end(async move {
            let _turn = jobs.turn.lock().await;
            change(Arc::clone(&jobs)).await
        })
        .await
    }
}
