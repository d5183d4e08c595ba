//! Images as they are asked for one by one or in frame order.

use spec::ArtifactEntry;
use sqlx::Row;
use sqlx::query::Query;
use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteConnection, SqliteRow};

use crate::error::CatalogueError;
use crate::filter::Bind;
use crate::types::ImageRow;

pub(crate) type Statement<'q> = Query<'q, Sqlite, SqliteArguments>;

/// Binds a value of a column.
pub(crate) fn bound<'q>(statement: Statement<'q>, value: Option<&Bind>) -> Statement<'q> {
    match value {
        None => statement.bind(None::<f64>),
        Some(Bind::Number(number)) => statement.bind(*number),
        Some(Bind::Whole(number)) => statement.bind(*number),
        Some(Bind::Text(text)) => statement.bind(text.clone()),
    }
}

pub(crate) async fn get(
    connection: &mut SqliteConnection,
    job: &str,
    frame: u64,
) -> Result<Option<ImageRow>, CatalogueError> {
    let Ok(frame) = i64::try_from(frame) else {
        return Ok(None);
    };
    let found = sqlx::query(
        "SELECT job_id, dataset, created_ms, record FROM images JOIN records USING (job_id, frame)
         WHERE job_id = ? AND frame = ? AND job_id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(job)
    .bind(frame)
    .fetch_optional(connection)
    .await?;
    found.as_ref().map(row).transpose()
}

/// Images of a job in frame order, those after a frame.
pub(crate) async fn after(
    connection: &mut SqliteConnection,
    job: &str,
    after: Option<u64>,
    limit: u32,
) -> Result<Vec<ImageRow>, CatalogueError> {
    let rows = sqlx::query(
        "SELECT job_id, dataset, created_ms, record FROM images JOIN records USING (job_id, frame)
         WHERE job_id = ? AND frame > ? AND job_id NOT IN (SELECT job_id FROM deletions)
         ORDER BY frame LIMIT ?",
    )
    .bind(job)
    .bind(place(after))
    .bind(limit)
    .fetch_all(connection)
    .await?;
    rows.iter().map(row).collect()
}

/// What frames after a frame are larger than.
pub(crate) fn place(after: Option<u64>) -> i64 {
    after.map_or(-1, |frame| i64::try_from(frame).unwrap_or(i64::MAX))
}

fn row(row: &SqliteRow) -> Result<ImageRow, CatalogueError> {
    Ok(ImageRow {
        job_id: row.try_get(0)?,
        dataset: row.try_get(1)?,
        created_ms: row.try_get::<i64, _>(2)? as u64,
        record: serde_json::from_str(&row.try_get::<String, _>(3)?)?,
    })
}

pub(crate) async fn artifact(
    connection: &mut SqliteConnection,
    job: &str,
    frame: u64,
    kind: &str,
) -> Result<Option<ArtifactEntry>, CatalogueError> {
    let Ok(frame) = i64::try_from(frame) else {
        return Ok(None);
    };
    let found = sqlx::query(
        "SELECT kind, digest, bytes, media_type FROM artifacts
         WHERE job_id = ? AND frame = ? AND kind = ? AND job_id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(job)
    .bind(frame)
    .bind(kind)
    .fetch_optional(connection)
    .await?;
    let Some(row) = found else { return Ok(None) };
    Ok(Some(ArtifactEntry {
        kind: row.try_get(0)?,
        digest: row.try_get(1)?,
        bytes: row.try_get::<i64, _>(2)? as u64,
        media_type: row.try_get(3)?,
    }))
}
