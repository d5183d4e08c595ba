//! Storing images, and reading them one by one or in frame order.

use client::UnixMs;
use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;
use spec::{ArtifactEntry, FrameRecord};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

use crate::catalogue::{Catalogue, within};
use crate::commit::insert::NewImage;
use crate::digests::record_row::About;
use crate::error::CatalogueError;
use crate::image_id::ImageId;
use crate::query::cells::Cells;
use crate::types::{Delivery, FrameRows, InsertImage, Place, StoredArtifact};

impl Catalogue {
    /// Stores an image with its measurements, artifact names and the job's counters, all or nothing.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for a deleted job.
    pub async fn insert_image(
        &self,
        job: &str,
        record: &FrameRecord,
        now_ms: u64,
    ) -> Result<InsertImage, CatalogueError> {
        let image = NewImage::new(&self.columns, job, record, now_ms, &BTreeMap::new())?;
        self.writer()?.insert(image).await
    }

    /// Stores an image from a worker that the service does not trust, with its delivery.
    ///
    /// # Errors
    /// As [`Catalogue::insert_image`].
    pub async fn insert_delivered(
        &self,
        job: &str,
        record: &FrameRecord,
        now_ms: u64,
        delivery: Option<Delivery>,
    ) -> Result<InsertImage, CatalogueError> {
        let image = NewImage::new(&self.columns, job, record, now_ms, &BTreeMap::new())?;
        self.writer()?.insert(image.with_delivery(delivery)).await
    }

    /// An image: its record, with its job, its dataset and when it was stored.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn image(&self, job: &str, frame: u64) -> Result<Option<Value>, CatalogueError> {
        let found = self.image_row(job, frame).await?;
        self.note_if_damaged(found.as_ref().map(image).transpose())
    }

    /// The row of an image, as [`About::verified`] reads it.
    async fn image_row(&self, job: &str, frame: u64) -> Result<Option<SqliteRow>, CatalogueError> {
        let found = sqlx::query(
            "SELECT images.job_id, images.frame, dataset, created_ms, digest, record, row_digest
             FROM images LEFT JOIN records ON records.job_id = images.job_id AND records.frame = images.frame
             WHERE images.job_id = ? AND images.frame = ? AND images.job_id NOT IN (SELECT job_id FROM deletions)",
        )
        .bind(job)
        .bind(number(frame))
        .fetch_optional(&mut *self.reader().await?)
        .await?;
        Ok(found)
    }

    /// Images of a job in frame order, those after a frame. Damaged ones are left out, named and noted.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn results(
        &self,
        job: &str,
        after: Option<u64>,
        limit: u32,
    ) -> Result<FrameRows, CatalogueError> {
        let mut reader = self.reader().await?;
        let rows = sqlx::query(
            "SELECT images.job_id, images.frame, dataset, created_ms, digest, record, row_digest
             FROM images LEFT JOIN records ON records.job_id = images.job_id AND records.frame = images.frame
             WHERE images.job_id = ? AND images.frame > ? AND images.job_id NOT IN (SELECT job_id FROM deletions)
             ORDER BY images.frame LIMIT ?",
        )
        .bind(job)
        .bind(after.map_or(-1, number))
        .bind(limit)
        .fetch_all(&mut *reader);
        let rows = within(async { Ok(rows.await?) }).await?;
        let mut found = FrameRows::default();
        for row in &rows {
            found
                .rows
                .extend(self.damage.skip(image(row), &mut found.damaged)?);
        }
        let last = rows.last().filter(|_| rows.len() == limit as usize);
        found.next = last
            .map(|row| row.try_get::<i64, _>(1))
            .transpose()?
            .map(|frame| frame as u64);
        Ok(found)
    }

    /// The digest, length and type of an artifact, and where its bytes are.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn artifact(
        &self,
        job: &str,
        frame: u64,
        kind: &str,
    ) -> Result<Option<StoredArtifact>, CatalogueError> {
        let found = sqlx::query(
            "SELECT artifacts.digest, bytes, media_type, tar_offset,
                    CASE WHEN tar_offset IS NOT NULL THEN (SELECT set_location FROM jobs WHERE id = job_id) END,
                    CASE WHEN tar_offset IS NOT NULL THEN
                        (SELECT tar FROM shards
                         WHERE shards.job_id = artifacts.job_id AND shards.frame <= artifacts.frame
                         ORDER BY shards.frame DESC LIMIT 1) END
             FROM artifacts
             WHERE job_id = ? AND frame = ? AND kind = ? AND job_id NOT IN (SELECT job_id FROM deletions)",
        )
        .bind(job)
        .bind(number(frame))
        .bind(kind)
        .fetch_optional(&mut *self.reader().await?)
        .await?;
        let image = ImageId {
            job: job.to_owned(),
            frame,
        };
        let found = found.as_ref().map(|row| stored(image, kind, row)).transpose()?;
        let Some(image) = self.image_row(job, frame).await? else {
            return Ok(None);
        };
        // Only the place is read from the row, since its bytes are verified anyway; kind and digest are those of the record.
        let (about, record) = self.note_if_damaged(About::verified(&image))?;
        let Listed { artifacts } = serde_json::from_str(record)?;
        let entry = artifacts.into_iter().find(|entry| entry.kind == kind);
        if found.as_ref().map(|artifact| &artifact.entry) != entry.as_ref() {
            let part = format!("artifact `{kind}`");
            return self.note_if_damaged(Err(CatalogueError::damaged_image(&part, about.image())));
        }
        Ok(found)
    }
}

/// A frame's number for SQLite; numbers beyond its range belong to no frame.
pub(crate) fn number(frame: u64) -> i64 {
    i64::try_from(frame).unwrap_or(i64::MAX)
}

/// The artifacts of a record.
#[derive(Deserialize)]
struct Listed {
    artifacts: Vec<ArtifactEntry>,
}

fn stored(image: ImageId, kind: &str, row: &SqliteRow) -> Result<StoredArtifact, CatalogueError> {
    let mut cells = Cells::new(row);
    let entry = ArtifactEntry {
        kind: kind.to_owned(),
        digest: cells.take()?,
        bytes: cells.count()?,
        media_type: cells.take()?,
    };
    let place = match cells.take::<Option<i64>>()? {
        None => None,
        Some(offset) => Some(Place {
            set: cells.take()?,
            tar: cells.take()?,
            offset: offset as u64,
        }),
    };
    Ok(StoredArtifact { image, entry, place })
}

fn image(row: &SqliteRow) -> Result<Value, CatalogueError> {
    let (about, record) = About::verified(row)?;
    let mut image: Value = serde_json::from_str(record)?;
    if let Some(members) = image.as_object_mut() {
        members.insert("job".to_owned(), about.job.into());
        members.insert("dataset".to_owned(), about.dataset.into());
        let created_at = UnixMs(about.created_ms as u64).to_string();
        members.insert("created_at".to_owned(), created_at.into());
    }
    Ok(image)
}
