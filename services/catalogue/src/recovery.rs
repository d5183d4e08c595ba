//! What an earlier life of the service left open, and what failed.

use std::ops::Range;

use sqlx::Row;
use sqlx::sqlite::SqliteConnection;

use crate::error::CatalogueError;
use crate::types::{FailureRow, JobRow, OpenJob};
use crate::{images, jobs};

pub(crate) async fn open_jobs(connection: &mut SqliteConnection) -> Result<Vec<OpenJob>, CatalogueError> {
    let rows = sqlx::query(
        "SELECT id, dataset, spec, frames, done, failed, state, version, priority, created_ms, started_ms, finished_ms, digest,
                bytes
         FROM jobs
         WHERE state IN ('queued', 'running', 'paused') AND id NOT IN (SELECT job_id FROM deletions) ORDER BY id",
    )
    .fetch_all(&mut *connection)
    .await?;
    let mut open = Vec::with_capacity(rows.len());
    for row in rows {
        open.push(what_is_left(connection, jobs::row(&row)?).await?);
    }
    Ok(open)
}

pub(crate) async fn open_job(
    connection: &mut SqliteConnection,
    id: &str,
) -> Result<Option<OpenJob>, CatalogueError> {
    match jobs::get(connection, id).await? {
        Some(row) if !row.state.has_ended() => Ok(Some(what_is_left(connection, row).await?)),
        _ => Ok(None),
    }
}

async fn what_is_left(connection: &mut SqliteConnection, row: JobRow) -> Result<OpenJob, CatalogueError> {
    let done = done_ranges(connection, &row.id).await?;
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
    })
}

/// Runs of neighbouring frames that have an image: the frame number less its place in the list is constant in a run.
async fn done_ranges(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<Vec<Range<u64>>, CatalogueError> {
    let rows = sqlx::query(
        "SELECT min(frame), max(frame) + 1
         FROM (SELECT frame, frame - row_number() OVER (ORDER BY frame) AS run FROM images WHERE job_id = ?)
         GROUP BY run ORDER BY 1",
    )
    .bind(job)
    .fetch_all(connection)
    .await?;
    let range = |row: &sqlx::sqlite::SqliteRow| -> Result<Range<u64>, sqlx::Error> {
        Ok(row.try_get::<i64, _>(0)? as u64..row.try_get::<i64, _>(1)? as u64)
    };
    Ok(rows.iter().map(range).collect::<Result<_, _>>()?)
}

pub(crate) async fn failures(
    connection: &mut SqliteConnection,
    job: &str,
    after: Option<u64>,
    limit: u32,
) -> Result<Vec<FailureRow>, CatalogueError> {
    let rows = sqlx::query(
        "SELECT frame, strikes, quarantined, error FROM failures
         WHERE job_id = ? AND frame > ? AND job_id NOT IN (SELECT job_id FROM deletions)
         ORDER BY frame LIMIT ?",
    )
    .bind(job)
    .bind(images::place(after))
    .bind(limit)
    .fetch_all(connection)
    .await?;
    let failure = |row: &sqlx::sqlite::SqliteRow| -> Result<FailureRow, sqlx::Error> {
        Ok(FailureRow {
            frame: row.try_get::<i64, _>(0)? as u64,
            strikes: row.try_get(1)?,
            quarantined: row.try_get(2)?,
            error: row.try_get(3)?,
        })
    };
    Ok(rows.iter().map(failure).collect::<Result<_, _>>()?)
}
