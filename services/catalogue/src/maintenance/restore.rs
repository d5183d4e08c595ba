//! Restoring damaged rows from intact ones.

use std::collections::BTreeMap;

use serde::Deserialize;
use spec::FrameRecord;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::Catalogue;
use crate::commit::insert::{self, NewImage};
use crate::digests::row_digests::Side;
use crate::error::CatalogueError;
use crate::images::stored::number;
use crate::jobs::rows;
use crate::query::columns::Columns;
use crate::replica::files as replica_files;

/// The readable values in the rows of an image.
struct Stored {
    dataset: String,
    created_ms: u64,
    digest: String,
    artifacts: Vec<(String, String)>,
    offsets: BTreeMap<String, u64>,
}

impl Catalogue {
    /// Restores the rows of an image from its record. Returns false if the record is damaged.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn restore_from_record(&self, job: &str, frame: u64) -> Result<bool, CatalogueError> {
        let record = match self.image(job, frame).await {
            Ok(Some(image)) => FrameRecord::deserialize(&image)?,
            Ok(None) | Err(CatalogueError::Damaged { .. }) => return Ok(false),
            Err(error) => return Err(error),
        };
        self.restore_image(job, record).await
    }

    /// Restores all rows of an image from the record of its frame, rendered again. Returns false, without a change, if its artifacts
    /// differ from those of the image.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn restore_image(&self, job: &str, record: FrameRecord) -> Result<bool, CatalogueError> {
        let (job, columns) = (job.to_owned(), self.columns.clone());
        self.write(move |c| Box::pin(async move { restore(c, &columns, &job, &record).await }))
            .await
    }

    /// Recomputes the counts of all datasets, and rebuilds all indexes.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn restore_sums(&self) -> Result<(), CatalogueError> {
        self.write(|c| Box::pin(sums(c))).await
    }
}

async fn sums(connection: &mut SqliteConnection) -> Result<(), CatalogueError> {
    for sql in [
        "REINDEX",
        "DELETE FROM datasets",
        "INSERT INTO datasets (name, images, bytes, jobs)
         SELECT dataset, sum(done), sum(bytes), count(*) FROM jobs
         WHERE id NOT IN (SELECT job_id FROM deletions) GROUP BY dataset",
    ] {
        sqlx::query(sql).execute(&mut *connection).await?;
    }
    Ok(())
}

async fn restore(
    connection: &mut SqliteConnection,
    columns: &Columns,
    job: &str,
    record: &FrameRecord,
) -> Result<bool, CatalogueError> {
    let stored = stored(connection, job, record.frame).await?;
    let mut artifacts: Vec<_> = record
        .artifacts
        .iter()
        .map(|entry| (entry.kind.clone(), entry.digest.clone()))
        .collect();
    artifacts.sort();
    // Either of them may be damaged.
    if record.digest() != stored.digest && artifacts != stored.artifacts {
        return Ok(false);
    }
    for sql in [
        "DELETE FROM artifacts WHERE job_id = ? AND frame = ?",
        "DELETE FROM measurements WHERE job_id = ? AND frame = ?",
        "DELETE FROM records WHERE job_id = ? AND frame = ?",
        "DELETE FROM images WHERE job_id = ? AND frame = ?",
    ] {
        let gone = sqlx::query(sql).bind(job).bind(number(record.frame));
        gone.execute(&mut *connection).await?;
    }
    replica_files::drop_changed_rows(connection, job).await?;
    let image = NewImage::new(columns, job, record, stored.created_ms, &stored.offsets)?;
    insert::insert_rows(connection, columns, &[(&image, stored.dataset, false)]).await?;
    Ok(true)
}

async fn stored(connection: &mut SqliteConnection, job: &str, frame: u64) -> Result<Stored, CatalogueError> {
    let row = rows::get(connection, job, Side::Writer).await?;
    let row = row.ok_or_else(|| CatalogueError::not_found("job", job))?;
    let image: Option<(i64, Vec<u8>)> =
        sqlx::query_as("SELECT created_ms, CAST(digest AS BLOB) FROM images WHERE job_id = ? AND frame = ?")
            .bind(job)
            .bind(number(frame))
            .fetch_optional(&mut *connection)
            .await?;
    let (created_ms, digest) =
        image.ok_or_else(|| CatalogueError::not_found("image", &format!("{job}/{frame}")))?;
    let artifacts: Vec<(Vec<u8>, Vec<u8>, Option<i64>)> = sqlx::query_as(
        "SELECT CAST(kind AS BLOB), CAST(digest AS BLOB), tar_offset FROM artifacts
         WHERE job_id = ? AND frame = ? ORDER BY kind",
    )
    .bind(job)
    .bind(number(frame))
    .fetch_all(connection)
    .await?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Ok(Stored {
        dataset: row.dataset,
        created_ms: created_ms as u64,
        digest: text(&digest),
        offsets: artifacts
            .iter()
            .filter_map(|(kind, _, offset): &(Vec<u8>, Vec<u8>, Option<i64>)| {
                Some((text(kind), (*offset)? as u64))
            })
            .collect(),
        artifacts: artifacts
            .iter()
            .map(|(kind, digest, _)| (text(kind), text(digest)))
            .collect(),
    })
}
