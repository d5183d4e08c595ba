//! Images: a row with wide parameter columns, measurements, artifact names and the job's counters, all or nothing.

use spec::{ArtifactEntry, FrameRecord};
use sqlx::query::Query;
use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Row};

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::Bind;
use crate::jobs;
use crate::types::{ImageRow, InsertImage};

/// An image on its way in: what can be prepared before the writer has its turn.
pub(crate) struct NewImage {
    job: String,
    frame: i64,
    digest: String,
    record: String,
    /// Of the wide columns, in their order.
    parameters: Vec<Option<Bind>>,
    /// Of each subject, in the order of the metrics. One that the catalogue does not know stays in the record only.
    measurements: Vec<(String, Vec<Option<f64>>)>,
    metrics: Vec<String>,
    artifacts: Vec<ArtifactEntry>,
    now_ms: u64,
}

impl NewImage {
    pub(crate) fn new(
        columns: &Columns,
        job: &str,
        record: &FrameRecord,
        now_ms: u64,
    ) -> Result<Self, CatalogueError> {
        let json = serde_json::to_value(record)?;
        let metrics = columns.metrics();
        let measured = record.measurements.iter().map(|(subject, values)| {
            let values = metrics.iter().map(|metric| values.get(metric).copied());
            (subject.clone(), values.collect())
        });
        Ok(Self {
            job: job.to_owned(),
            frame: record.frame as i64,
            digest: record.digest(),
            record: json.to_string(),
            parameters: Columns::parameter_values(&json),
            measurements: measured.collect(),
            metrics: metrics.to_vec(),
            artifacts: record.artifacts.clone(),
            now_ms,
        })
    }

    fn bytes(&self) -> u64 {
        self.artifacts.iter().map(|artifact| artifact.bytes).sum()
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
    image: &NewImage,
) -> Result<InsertImage, CatalogueError> {
    let found = sqlx::query(
        "SELECT dataset, EXISTS (SELECT 1 FROM images WHERE job_id = ?1 AND frame = ?2),
                EXISTS (SELECT 1 FROM failures WHERE job_id = ?1 AND frame = ?2 AND quarantined = 1)
         FROM jobs WHERE id = ?1 AND id NOT IN (SELECT job_id FROM deletions)",
    )
    .bind(&image.job)
    .bind(image.frame)
    .fetch_optional(&mut *connection)
    .await?;
    let job = found.ok_or_else(|| CatalogueError::NotFound {
        what: "job",
        name: image.job.clone(),
    })?;
    let (dataset, there, was_given_up): (String, bool, bool) =
        (job.try_get(0)?, job.try_get(1)?, job.try_get(2)?);
    if there {
        return Ok(InsertImage::AlreadyThere);
    }
    insert_row(connection, image, &dataset).await?;
    insert_measurements(connection, image).await?;
    insert_artifacts(connection, image).await?;
    if was_given_up {
        sqlx::query("UPDATE failures SET quarantined = 0 WHERE job_id = ? AND frame = ?")
            .bind(&image.job)
            .bind(image.frame)
            .execute(&mut *connection)
            .await?;
    }
    sqlx::query("UPDATE datasets SET images = images + 1, bytes = bytes + ? WHERE name = ?")
        .bind(image.bytes() as i64)
        .bind(&dataset)
        .execute(&mut *connection)
        .await?;
    jobs::count_image(connection, &image.job, image.bytes(), was_given_up, image.now_ms).await?;
    Ok(InsertImage::Inserted)
}

async fn insert_row(
    connection: &mut SqliteConnection,
    image: &NewImage,
    dataset: &str,
) -> Result<(), CatalogueError> {
    let names: String = Columns::parameter_names()
        .map(|name| format!(", \"{name}\""))
        .collect();
    let sql = format!(
        "INSERT INTO images (job_id, frame, dataset, created_ms, digest{names}) VALUES (?, ?, ?, ?, ?{})",
        ", ?".repeat(image.parameters.len())
    );
    let mut statement = sqlx::query(AssertSqlSafe(sql))
        .bind(&image.job)
        .bind(image.frame)
        .bind(dataset)
        .bind(image.now_ms as i64)
        .bind(&image.digest);
    for value in &image.parameters {
        statement = bound(statement, value.as_ref());
    }
    statement.execute(&mut *connection).await?;
    sqlx::query("INSERT INTO records (job_id, frame, record) VALUES (?, ?, ?)")
        .bind(&image.job)
        .bind(image.frame)
        .bind(&image.record)
        .execute(connection)
        .await?;
    Ok(())
}

/// One row for each measured picture.
async fn insert_measurements(
    connection: &mut SqliteConnection,
    image: &NewImage,
) -> Result<(), CatalogueError> {
    if image.measurements.is_empty() {
        return Ok(());
    }
    let names: String = image.metrics.iter().map(|name| format!(", \"{name}\"")).collect();
    let row = format!("(?, ?, ?{})", ", ?".repeat(image.metrics.len()));
    let rows = vec![row; image.measurements.len()].join(", ");
    let sql = format!("INSERT INTO measurements (job_id, frame, subject{names}) VALUES {rows}");
    let mut statement = sqlx::query(AssertSqlSafe(sql));
    for (subject, values) in &image.measurements {
        statement = statement.bind(&image.job).bind(image.frame).bind(subject);
        for value in values {
            statement = statement.bind(*value);
        }
    }
    statement.execute(connection).await?;
    Ok(())
}

async fn insert_artifacts(connection: &mut SqliteConnection, image: &NewImage) -> Result<(), CatalogueError> {
    if image.artifacts.is_empty() {
        return Ok(());
    }
    let rows = vec!["(?, ?, ?, ?, ?, ?)"; image.artifacts.len()].join(", ");
    let sql = format!("INSERT INTO artifacts (job_id, frame, kind, digest, bytes, media_type) VALUES {rows}");
    let mut statement = sqlx::query(AssertSqlSafe(sql));
    for artifact in &image.artifacts {
        statement = statement
            .bind(&image.job)
            .bind(image.frame)
            .bind(&artifact.kind)
            .bind(&artifact.digest)
            .bind(artifact.bytes as i64)
            .bind(&artifact.media_type);
    }
    statement.execute(connection).await?;
    Ok(())
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
