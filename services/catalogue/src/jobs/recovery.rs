//! Open frames of an earlier run of the service, and failures.

use client::{FailureRow, JobRow};
use std::ops::Range;

use spec::Provenance;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::catalogue::{Catalogue, within};
use crate::commit::progress;
use crate::digests::row_digests::Side;
use crate::digests::tables::FAILURES;
use crate::error::CatalogueError;
use crate::images::stored;
use crate::query::cells::Cells;
use crate::types::OpenJob;

impl Catalogue {
    /// Records a failed attempt.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn record_strike(&self, job: &str, failure: FailureRow) -> Result<(), CatalogueError> {
        let job = job.to_owned();
        self.write(move |c| Box::pin(async move { progress::strike(c, &job, &failure).await }))
            .await
    }

    /// Failed frames of a job in frame order, those after a frame.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn failures(
        &self,
        job: &str,
        after: Option<u64>,
        limit: u32,
    ) -> Result<Vec<FailureRow>, CatalogueError> {
        within(failures(&mut *self.reader().await?, job, after, limit)).await
    }
}

pub(crate) async fn what_is_left(
    connection: &mut SqliteConnection,
    row: JobRow,
) -> Result<OpenJob, CatalogueError> {
    let done = done_ranges(connection, &row.id).await?;
    let provenance = provenance(connection, &row.id).await?;
    let (given_up, tried): (Vec<_>, Vec<_>) = failures(connection, &row.id, None, u32::MAX)
        .await?
        .into_iter()
        .partition(|failure| failure.quarantined);
    // A frame may have failed first and succeeded later.
    let has_image = |frame: u64| {
        let before = done.partition_point(|range| range.end <= frame);
        done.get(before).is_some_and(|range| range.contains(&frame))
    };
    let strikes = tried
        .into_iter()
        .filter(|f| !has_image(f.frame))
        .map(|f| (f.frame, f.strikes))
        .collect();
    Ok(OpenJob {
        failed: given_up.iter().map(|failure| failure.frame).collect(),
        row,
        done,
        strikes,
        provenance,
    })
}

/// The provenance of the first image of a job; some images of old catalogues have none.
async fn provenance(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<Option<Provenance>, CatalogueError> {
    let sql = "SELECT iif(json_valid(record), record, NULL) ->> '$.provenance' FROM records WHERE job_id = ? ORDER BY frame LIMIT 1";
    let text: Option<Option<String>> = sqlx::query_scalar(sql)
        .bind(job)
        .fetch_optional(connection)
        .await?;
    Ok(text.flatten().and_then(|text| serde_json::from_str(&text).ok()))
}

/// Frames per count. A complete run of frames costs one row of a query; only runs with gaps are listed frame by frame.
const RUN: u64 = 8192;

/// Runs of neighboring frames that have an image.
async fn done_ranges(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<Vec<Range<u64>>, CatalogueError> {
    let mut done: Vec<Range<u64>> = Vec::new();
    let mut next = first_image(connection, job, 0).await?;
    while let Some(start) = next {
        let end = start + RUN;
        if count_images(connection, job, start, end).await? == RUN {
            append(&mut done, start..end);
        } else {
            for frame in list_images(connection, job, start, end).await? {
                append(&mut done, frame..frame + 1);
            }
        }
        next = match i64::try_from(end) {
            Ok(_) => first_image(connection, job, end).await?,
            Err(_) => None,
        };
    }
    Ok(done)
}

async fn count_images(
    connection: &mut SqliteConnection,
    job: &str,
    start: u64,
    end: u64,
) -> Result<u64, CatalogueError> {
    let sql = "SELECT count(*) FROM images WHERE job_id = ? AND frame >= ? AND frame < ?";
    let images: i64 = sqlx::query_scalar(sql)
        .bind(job)
        .bind(stored::number(start))
        .bind(stored::number(end))
        .fetch_one(connection)
        .await?;
    Ok(images as u64)
}

async fn list_images(
    connection: &mut SqliteConnection,
    job: &str,
    start: u64,
    end: u64,
) -> Result<Vec<u64>, CatalogueError> {
    let sql = "SELECT frame FROM images WHERE job_id = ? AND frame >= ? AND frame < ? ORDER BY frame";
    let frames: Vec<i64> = sqlx::query_scalar(sql)
        .bind(job)
        .bind(stored::number(start))
        .bind(stored::number(end))
        .fetch_all(connection)
        .await?;
    Ok(frames.into_iter().map(|frame| frame as u64).collect())
}

/// Appends a range, or extends the last one by it.
fn append(ranges: &mut Vec<Range<u64>>, range: Range<u64>) {
    match ranges.last_mut() {
        Some(last) if last.end == range.start => last.end = range.end,
        _ => ranges.push(range),
    }
}

/// The first frame with an image, from a frame on.
async fn first_image(
    connection: &mut SqliteConnection,
    job: &str,
    from: u64,
) -> Result<Option<u64>, CatalogueError> {
    let first: Option<i64> =
        sqlx::query_scalar("SELECT min(frame) FROM images WHERE job_id = ? AND frame >= ?")
            .bind(job)
            .bind(stored::number(from))
            .fetch_one(connection)
            .await?;
    Ok(first.map(|frame| frame as u64))
}

async fn failures(
    connection: &mut SqliteConnection,
    job: &str,
    after: Option<u64>,
    limit: u32,
) -> Result<Vec<FailureRow>, CatalogueError> {
    let rows = sqlx::query(
        "SELECT job_id, frame, strikes, quarantined, error, row_digest FROM failures
         WHERE job_id = ? AND frame > ? AND job_id NOT IN (SELECT job_id FROM deletions)
         ORDER BY frame LIMIT ?",
    )
    .bind(job)
    .bind(after.map_or(-1, stored::number))
    .bind(limit)
    .fetch_all(connection)
    .await?;
    rows.iter()
        .map(|row: &SqliteRow| -> Result<FailureRow, CatalogueError> {
            FAILURES.verify(row, Side::Reader)?;
            let mut cells = Cells::new(row);
            cells.take::<&str>()?;
            Ok(FailureRow {
                frame: cells.count()?,
                strikes: cells.take()?,
                quarantined: cells.take()?,
                error: cells.take()?,
            })
        })
        .collect()
}
