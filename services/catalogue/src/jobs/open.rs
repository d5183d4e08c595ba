//! Jobs that have not ended.

use client::JobRow;

use super::rows::verified;
use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::digests::tables::digested_job_columns;
use crate::error::CatalogueError;
use crate::jobs::recovery;
use crate::types::OpenJob;

impl Catalogue {
    /// Open jobs that this service renders, except jobs that start again ([`Catalogue::continue_restart`]). Damaged ones are
    /// reported and left out.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn open_jobs(&self) -> Result<Vec<OpenJob>, CatalogueError> {
        let mut reader = self.reader().await?;
        let rows = sqlx::query(concat!(
            "SELECT ",
            digested_job_columns!(),
            " FROM jobs
              WHERE state IN ('queued', 'running', 'paused') AND set_location IS NULL AND restarting IS NULL
                AND id NOT IN (SELECT job_id FROM deletions) ORDER BY id",
        ));
        let rows = rows.fetch_all(&mut *reader).await?;
        let mut open = Vec::with_capacity(rows.len());
        for found in &rows {
            let row = match self.unless_damaged(verified(found, Side::Reader)) {
                Some(row) => row?,
                None => continue,
            };
            let left = recovery::what_is_left(&mut reader, row).await;
            open.extend(self.unless_damaged(left).transpose()?);
        }
        Ok(open)
    }

    /// The state of the frames of an open job.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn open_job(&self, row: JobRow) -> Result<OpenJob, CatalogueError> {
        recovery::what_is_left(&mut *self.reader().await?, row).await
    }

    /// The open jobs of a caller that the workers of a broker render. Damaged ones are reported and left out.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn open_shared_jobs(&self, owner: &str) -> Result<Vec<JobRow>, CatalogueError> {
        let rows = sqlx::query(concat!(
            "SELECT ",
            digested_job_columns!(),
            " FROM jobs
              WHERE owner = ? AND state IN ('queued', 'running', 'paused') AND set_location IS NOT NULL
                AND id NOT IN (SELECT job_id FROM deletions)",
        ));
        let rows = rows.bind(owner).fetch_all(&mut *self.reader().await?).await?;
        rows.iter()
            .filter_map(|row| self.unless_damaged(verified(row, Side::Reader)))
            .collect()
    }
}
