//! Images: a row with wide parameter columns, measurements, artifact names and the job's counters, all or nothing.

use serde_json::Value;
use spec::{ArtifactEntry, FrameRecord};
use sqlx::query::Query;
use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteConnection};
use sqlx::{AssertSqlSafe, Row};

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::Bind;
use crate::jobs;
use crate::types::{ImageRow, InsertImage};

/// An image on its way in.
pub(crate) struct NewImage {
    job: String,
    record: FrameRecord,
    json: Value,
    digest: String,
    now_ms: u64,
}

impl NewImage {
    pub(crate) fn new(job: &str, record: &FrameRecord, now_ms: u64) -> Result<Self, CatalogueError> {
        let json = serde_json::to_value(record)?;
        Ok(Self {
            job: job.to_owned(),
            record: record.clone(),
            json,
            digest: record.digest(),
            now_ms,
        })
    }
}

type Statement<'q> = Query<'q, Sqlite, SqliteArguments>;

/// Binds a value of a column.
pub(crate) fn bound<'q>(statement: Statement<'q>, value: Option<&Bind>) -> Statement<'q> {
    match value {
        None => statement.bind(None::<f64>),
        Some(Bind::Number(number)) => statement.bind(*number),
        Some(Bind::Text(text)) => statement.bind(text.clone()),
    }
}

pub(crate) async fn insert(
    connection: &mut SqliteConnection,
    columns: &Columns,
    image: &NewImage,
) -> Result<InsertImage, CatalogueError> {
    let frame = image.record.frame as i64;
    let there: Option<i64> = sqlx::query_scalar("SELECT 1 FROM images WHERE job_id = ? AND frame = ?")
        .bind(&image.job)
        .bind(frame)
        .fetch_optional(&mut *connection)
        .await?;
    if there.is_some() {
        return Ok(InsertImage::AlreadyThere);
    }
    let dataset: Option<String> = sqlx::query_scalar("SELECT dataset FROM jobs WHERE id = ?")
        .bind(&image.job)
        .fetch_optional(&mut *connection)
        .await?;
    let dataset = dataset.ok_or_else(|| CatalogueError::NotFound {
        what: "job",
        name: image.job.clone(),
    })?;
    insert_row(connection, image, &dataset).await?;
    insert_measurements(connection, columns, image).await?;
    let bytes = insert_artifacts(connection, image).await?;
    sqlx::query("UPDATE datasets SET images = images + 1, bytes = bytes + ? WHERE name = ?")
        .bind(bytes as i64)
        .bind(&dataset)
        .execute(&mut *connection)
        .await?;
    sqlx::query("UPDATE jobs SET done = done + 1, version = version + 1 WHERE id = ?")
        .bind(&image.job)
        .execute(&mut *connection)
        .await?;
    jobs::advance(connection, &image.job, Some(image.now_ms)).await?;
    Ok(InsertImage::Inserted)
}

async fn insert_row(
    connection: &mut SqliteConnection,
    image: &NewImage,
    dataset: &str,
) -> Result<(), CatalogueError> {
    let names: Vec<String> = Columns::parameter_names()
        .map(|name| format!("\"{name}\""))
        .collect();
    let places = vec!["?"; names.len()].join(", ");
    let sql = format!(
        "INSERT INTO images (job_id, frame, dataset, created_ms, digest, record, {}) VALUES (?, ?, ?, ?, ?, ?, {places})",
        names.join(", ")
    );
    let mut statement = sqlx::query(AssertSqlSafe(sql))
        .bind(&image.job)
        .bind(image.record.frame as i64)
        .bind(dataset)
        .bind(image.now_ms as i64)
        .bind(&image.digest)
        .bind(image.json.to_string());
    for value in Columns::parameter_values(&image.json) {
        statement = bound(statement, value.as_ref());
    }
    statement.execute(connection).await?;
    Ok(())
}

/// One row for each measured picture. A metric that the catalogue does not know stays in the record only.
async fn insert_measurements(
    connection: &mut SqliteConnection,
    columns: &Columns,
    image: &NewImage,
) -> Result<(), CatalogueError> {
    for (subject, values) in &image.record.measurements {
        let known: Vec<(&String, f64)> = columns
            .metrics()
            .iter()
            .filter_map(|name| values.get(name).map(|value| (name, *value)))
            .collect();
        let names: String = known.iter().map(|(name, _)| format!(", \"{name}\"")).collect();
        let sql = format!(
            "INSERT INTO measurements (job_id, frame, subject{names}) VALUES (?, ?, ?{})",
            ", ?".repeat(known.len())
        );
        let mut statement = sqlx::query(AssertSqlSafe(sql))
            .bind(&image.job)
            .bind(image.record.frame as i64)
            .bind(subject);
        for (_, value) in known {
            statement = statement.bind(value);
        }
        statement.execute(&mut *connection).await?;
    }
    Ok(())
}

/// Answers the bytes of all artifacts.
async fn insert_artifacts(
    connection: &mut SqliteConnection,
    image: &NewImage,
) -> Result<u64, CatalogueError> {
    for artifact in &image.record.artifacts {
        sqlx::query(
            "INSERT INTO artifacts (job_id, frame, kind, digest, bytes, media_type) VALUES (?, ?, ?, ?, ?, ?)",
        )
        .bind(&image.job)
        .bind(image.record.frame as i64)
        .bind(&artifact.kind)
        .bind(&artifact.digest)
        .bind(artifact.bytes as i64)
        .bind(&artifact.media_type)
        .execute(&mut *connection)
        .await?;
    }
    Ok(image.record.artifacts.iter().map(|artifact| artifact.bytes).sum())
}

pub(crate) async fn get(
    connection: &mut SqliteConnection,
    job: &str,
    frame: u64,
) -> Result<Option<ImageRow>, CatalogueError> {
    let Ok(frame) = i64::try_from(frame) else {
        return Ok(None);
    };
    let found =
        sqlx::query("SELECT job_id, dataset, created_ms, record FROM images WHERE job_id = ? AND frame = ?")
            .bind(job)
            .bind(frame)
            .fetch_optional(connection)
            .await?;
    let Some(row) = found else { return Ok(None) };
    Ok(Some(ImageRow {
        job_id: row.try_get(0)?,
        dataset: row.try_get(1)?,
        created_ms: row.try_get::<i64, _>(2)? as u64,
        record: serde_json::from_str(&row.try_get::<String, _>(3)?)?,
    }))
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
        "SELECT kind, digest, bytes, media_type FROM artifacts WHERE job_id = ? AND frame = ? AND kind = ?",
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
