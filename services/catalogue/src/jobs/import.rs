//! Images of sets that were made without this service: rows are stored, bytes stay where they are.

use std::collections::BTreeMap;

use spec::RecordText;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::Catalogue;
use crate::commit::insert::{self, NewArtifact, NewImage};
use crate::commit::progress;
use crate::error::CatalogueError;
use crate::query::columns::Columns;
use crate::types::{ImportedShard, InsertImage, NewShard};

impl Catalogue {
    /// Prepares an image whose artifacts begin at these offsets of its shard's tar, by kind. Needs no turn of the writer.
    ///
    /// # Errors
    /// [`CatalogueError::Failed`] for a record that is none.
    pub fn imported_image(
        &self,
        job: &str,
        record: &RecordText,
        created_ms: u64,
        offsets: &BTreeMap<String, u64>,
    ) -> Result<NewImage, CatalogueError> {
        NewImage::imported(&self.columns, job, record, created_ms, offsets)
    }

    /// Stores images of a shard, all or nothing; returns the number of new ones. The place in the tar of an existing image is updated,
    /// since a damaged shard may have been rendered again into another tar.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for a deleted job; [`CatalogueError::Contradicted`] for an existing image with other artifacts.
    pub async fn import(
        &self,
        job: &str,
        images: Vec<NewImage>,
        shard: NewShard,
    ) -> Result<u64, CatalogueError> {
        let (job, columns) = (job.to_owned(), self.columns.clone());
        self.write(move |c| Box::pin(async move { import(c, &columns, &job, &images, &shard).await }))
            .await
    }

    /// The completely imported shards of a job, by their first frame.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn imported_shards(&self, job: &str) -> Result<Vec<ImportedShard>, CatalogueError> {
        let rows: Vec<(i64, String, i64)> = sqlx::query_as(
            "SELECT frame, digest, changed_ms FROM shards
             WHERE job_id = ? AND digest IS NOT NULL AND changed_ms IS NOT NULL ORDER BY frame",
        )
        .bind(job)
        .fetch_all(&mut *self.reader().await?)
        .await?;
        Ok(rows
            .into_iter()
            .map(|(frame, digest, changed_ms)| ImportedShard {
                frame: frame as u64,
                digest,
                changed_ms,
            })
            .collect())
    }

    /// How many shards of a job are imported as a whole, and when the last of their markers was written; 0 without one.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn imported_extent(&self, job: &str) -> Result<(u64, i64), CatalogueError> {
        let (count, changed_ms): (i64, i64) = sqlx::query_as(
            "SELECT count(*), coalesce(max(changed_ms), 0) FROM shards WHERE job_id = ? AND digest IS NOT NULL",
        )
        .bind(job)
        .fetch_one(&mut *self.reader().await?)
        .await?;
        Ok((count as u64, changed_ms))
    }
}

async fn import(
    connection: &mut SqliteConnection,
    columns: &Columns,
    job: &str,
    images: &[NewImage],
    shard: &NewShard,
) -> Result<u64, CatalogueError> {
    note_tar(connection, job, shard).await?;
    let all: Vec<&NewImage> = images.iter().collect();
    let mut new = 0;
    for (image, stored) in images
        .iter()
        .zip(insert::insert(connection, columns, &all).await?)
    {
        match stored? {
            InsertImage::Inserted => new += 1,
            InsertImage::AlreadyThere => place(connection, image).await?,
        }
    }
    if let Some(end) = &shard.end {
        for failure in &end.failed {
            progress::strike(connection, job, failure).await?;
        }
        sqlx::query("UPDATE shards SET digest = ?, changed_ms = ? WHERE job_id = ? AND frame = ?")
            .bind(&end.digest)
            .bind(end.changed_ms)
            .bind(job)
            .bind(shard.frame as i64)
            .execute(connection)
            .await?;
    }
    Ok(new)
}

/// Stored before the images, so that every image has its tar at any time.
async fn note_tar(
    connection: &mut SqliteConnection,
    job: &str,
    shard: &NewShard,
) -> Result<(), CatalogueError> {
    let noted = sqlx::query(
        "INSERT INTO shards (job_id, frame, tar)
         SELECT id, ?2, ?3 FROM jobs WHERE id = ?1 AND id NOT IN (SELECT job_id FROM deletions)
         ON CONFLICT (job_id, frame) DO UPDATE SET tar = excluded.tar, digest = NULL, changed_ms = NULL",
    )
    .bind(job)
    .bind(shard.frame as i64)
    .bind(&shard.tar)
    .execute(connection)
    .await?;
    match noted.rows_affected() {
        0 => Err(CatalogueError::not_found("job", job)),
        _ => Ok(()),
    }
}

async fn place(connection: &mut SqliteConnection, image: &NewImage) -> Result<(), CatalogueError> {
    for NewArtifact { entry, offset } in &image.artifacts {
        let placed = sqlx::query(
            "UPDATE artifacts SET tar_offset = ? WHERE job_id = ? AND frame = ? AND kind = ? AND digest = ? AND bytes = ?",
        )
        .bind(*offset)
        .bind(&image.job)
        .bind(image.frame)
        .bind(&entry.kind)
        .bind(&entry.digest)
        .bind(entry.bytes as i64)
        .execute(&mut *connection)
        .await?;
        if placed.rows_affected() == 0 {
            return Err(CatalogueError::Contradicted {
                job: image.job.clone(),
                frame: image.frame as u64,
            });
        }
    }
    Ok(())
}
