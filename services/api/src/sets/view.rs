//! A set as shown to clients.

use catalogue::JobRow;
use client::SetView;

use super::Sets;
use super::followed::Last;
use crate::http::problem::{Problem, found};

impl Sets {
    /// Every set, newest first.
    pub(super) async fn all(&self) -> Result<Vec<SetView>, Problem> {
        let mut views = Vec::new();
        for row in self.jobs.catalogue.imported_jobs().await? {
            views.push(self.view(row).await?);
        }
        Ok(views)
    }

    /// The set of a job.
    pub(super) async fn get(&self, job: &str) -> Result<SetView, Problem> {
        let row = self.jobs.catalogue.job(job).await?;
        let row = found(row.filter(|row| row.set.is_some()), "set with the job", job)?;
        self.view(row).await
    }

    pub(super) async fn view(&self, row: JobRow) -> Result<SetView, Problem> {
        let (shards, _) = self.jobs.catalogue.imported_extent(&row.id).await?;
        let followed = self.followed().get(&row.id).cloned();
        let last = followed.map(|followed| followed.last().clone());
        let Last { goes_on, at, error } = last.unwrap_or_default();
        Ok(SetView {
            job: row.id,
            url: row.set.unwrap_or_default(),
            dataset: row.dataset,
            state: row.state,
            frames: row.frames,
            done: row.done,
            failed: row.failed,
            shards,
            followed: goes_on,
            looked_at: at,
            error,
        })
    }
}
