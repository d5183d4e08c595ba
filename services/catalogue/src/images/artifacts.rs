//! Digests of stored bytes and the rows that name them.

use spec::ArtifactEntry;
use sqlx::sqlite::SqliteRow;

use crate::catalogue::{Catalogue, within};
use crate::error::CatalogueError;
use crate::images::stored;
use crate::query::cells::Cells;
use crate::types::{ImportedArtifact, NamedDigest, Place};

impl Catalogue {
    /// Digests of artifacts in the packs in order, those after a digest, each with one of the rows that name it.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn artifacts_after(
        &self,
        after: Option<&str>,
        limit: u32,
    ) -> Result<Vec<NamedDigest>, CatalogueError> {
        let mut reader = self.reader().await?;
        // The other columns are those of the row with the minimum (a guarantee of SQLite).
        let rows = sqlx::query_as(
            "SELECT digest, min(job_id), frame, kind, bytes FROM artifacts
             WHERE digest > ? AND tar_offset IS NULL AND job_id NOT IN (SELECT job_id FROM deletions)
             GROUP BY digest ORDER BY digest LIMIT ?",
        )
        .bind(after.unwrap_or(""))
        .bind(limit)
        .fetch_all(&mut *reader);
        let rows: Vec<(String, String, i64, String, i64)> = within(async { Ok(rows.await?) }).await?;
        Ok(rows
            .into_iter()
            .map(|(digest, job_id, frame, kind, bytes)| NamedDigest {
                digest,
                job_id,
                frame: frame as u64,
                kind,
                bytes: bytes as u64,
            })
            .collect())
    }
    /// Artifacts of an imported job by frame and kind, those after one of them.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn imported_artifacts(
        &self,
        job: &str,
        after: Option<&ImportedArtifact>,
        limit: u32,
    ) -> Result<Vec<ImportedArtifact>, CatalogueError> {
        let mut reader = self.reader().await?;
        let rows = sqlx::query(
            "SELECT job_id, frame, kind, artifacts.digest, bytes, media_type, tar_offset,
                    (SELECT set_location FROM jobs WHERE id = job_id),
                    (SELECT tar FROM shards WHERE shards.job_id = artifacts.job_id AND shards.frame <= artifacts.frame
                     ORDER BY shards.frame DESC LIMIT 1)
             FROM artifacts
             WHERE job_id = ? AND (frame, kind) > (?, ?) AND tar_offset IS NOT NULL
               AND job_id NOT IN (SELECT job_id FROM deletions)
             ORDER BY frame, kind LIMIT ?",
        )
        .bind(job)
        .bind(after.map_or(-1, |artifact| stored::number(artifact.frame)))
        .bind(after.map_or("", |artifact| &artifact.entry.kind))
        .bind(limit)
        .fetch_all(&mut *reader);
        let rows = within(async { Ok(rows.await?) }).await?;
        rows.iter().map(imported).collect()
    }
}

fn imported(row: &SqliteRow) -> Result<ImportedArtifact, CatalogueError> {
    let mut cells = Cells::new(row);
    let (job_id, frame) = (cells.take()?, cells.count()?);
    let entry = ArtifactEntry {
        kind: cells.take()?,
        digest: cells.take()?,
        bytes: cells.count()?,
        media_type: cells.take()?,
    };
    let offset = cells.count()?;
    let (set, tar) = (cells.take()?, cells.take()?);
    Ok(ImportedArtifact {
        job_id,
        frame,
        entry,
        place: Place { set, tar, offset },
    })
}
