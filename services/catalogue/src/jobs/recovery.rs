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

/// Runs of neighboring frames that have an image: the frame number less its place in the list is constant in a run.
async fn done_ranges(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<Vec<Range<u64>>, CatalogueError> {
    let rows: Vec<(i64, i64)> = sqlx::query_as(
        "SELECT min(frame), max(frame) + 1
         FROM (SELECT frame, frame - row_number() OVER (ORDER BY frame) AS run FROM images WHERE job_id = ?)
         GROUP BY run ORDER BY 1",
    )
    .bind(job)
    .fetch_all(connection)
    .await?;
    Ok(rows
        .into_iter()
        .map(|(start, end)| start as u64..end as u64)
        .collect())
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
