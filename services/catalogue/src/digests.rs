//! Digests of stored bytes and the rows that name them.

use crate::catalogue::{Catalogue, within};
use crate::error::CatalogueError;
use crate::types::NamedDigest;

impl Catalogue {
    /// Digests of artifacts in order, those after a digest, each with one of the rows that name it.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn artifacts_after(
        &self,
        after: Option<&str>,
        limit: u32,
    ) -> Result<Vec<NamedDigest>, CatalogueError> {
        let mut reader = self.reader().await?;
        // SQLite takes the other columns from the row that has the minimum.
        let rows = sqlx::query_as(
            "SELECT digest, min(job_id), frame, kind, bytes FROM artifacts
             WHERE digest > ? AND job_id NOT IN (SELECT job_id FROM deletions)
             GROUP BY digest ORDER BY digest LIMIT ?",
        )
        .bind(after.unwrap_or(""))
        .bind(limit)
        .fetch_all(&mut *reader);
        let rows: Vec<(String, String, i64, String, i64)> = within(async { Ok(rows.await?) }).await?;
        let named = |(digest, job_id, frame, kind, bytes)| NamedDigest {
            digest,
            job_id,
            frame: frame as u64,
            kind,
            bytes: bytes as u64,
        };
        Ok(rows.into_iter().map(named).collect())
    }
}
