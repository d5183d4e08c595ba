//! The warnings of a job's frames, counted by their text.

use client::FrameWarning;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::Catalogue;
use crate::error::CatalogueError;

/// Most frames with warnings that are read: enough for a summary, few enough for one query.
const MOST_FRAMES: i64 = 10_000;
/// Most different texts.
const MOST_TEXTS: i64 = 50;

impl Catalogue {
    /// The warnings of the frames of a job, the most frequent first.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn frame_warnings(&self, job: &str) -> Result<Vec<FrameWarning>, CatalogueError> {
        list(&mut *self.reader().await?, job).await
    }
}

async fn list(connection: &mut SqliteConnection, job: &str) -> Result<Vec<FrameWarning>, CatalogueError> {
    let rows: Vec<(String, i64, i64)> = sqlx::query_as(
        "SELECT warning.value, count(*), min(frame) FROM
           (SELECT images.frame, record FROM images JOIN records USING (job_id, frame)
            WHERE images.job_id = ?1 AND images.warnings > 0 AND json_valid(record) AND images.job_id NOT IN (SELECT job_id FROM deletions)
            ORDER BY images.frame LIMIT ?2),
           json_each(record, '$.warnings') AS warning
         GROUP BY 1 ORDER BY 2 DESC, 1 LIMIT ?3",
    )
    .bind(job)
    .bind(MOST_FRAMES)
    .bind(MOST_TEXTS)
    .fetch_all(connection)
    .await?;
    let rows = rows
        .into_iter()
        .map(|(warning, frames, first_frame)| FrameWarning {
            warning,
            frames: frames.unsigned_abs(),
            first_frame: first_frame.unsigned_abs(),
        });
    Ok(rows.collect())
}
