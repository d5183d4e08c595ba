//! Verifies every row against its digest, and the rows of an image against its record.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Connection, Row};

use crate::catalogue::Catalogue;
use crate::digests::record_row::About;
use crate::digests::row_digests::intact;
use crate::digests::tables::TABLES;
use crate::error::CatalogueError;
use crate::maintenance::upkeep::MOST_FINDINGS;
use crate::query::column_value::value;
use crate::query::columns::Columns;
use crate::query::filter::{Column, Kind};
use crate::query::record_value::RecordValue;

/// Images that are in memory at one time.
const BATCH: i64 = 500;

/// A damaged row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DamagedRow {
    /// The row and the damaged part.
    pub what: String,
    /// The image that it belongs to, which has all its rows again once its frame is rendered again.
    #[serde(skip)]
    pub image: Option<(String, u64)>,
}

/// Job, frame, kind, digest, bytes and media type; texts as bytes, since damaged ones need not be text.
type Artifact = (String, i64, Vec<u8>, Vec<u8>, i64, Vec<u8>);

/// The rows of some images except their records.
#[derive(Default)]
struct Beside {
    measured: BTreeMap<(String, i64), BTreeMap<String, Vec<Value>>>,
    artifacts: BTreeMap<(String, i64), Vec<Value>>,
}

impl Catalogue {
    /// All damaged rows. Reads the whole catalogue.
    ///
    /// # Errors
    /// [`CatalogueError`] for pages that SQLite cannot read.
    pub async fn damaged_rows(&self) -> Result<Vec<DamagedRow>, CatalogueError> {
        let mut connection = self.apart().await?;
        let mut transaction = connection.begin().await?;
        let mut damaged = Vec::new();
        let row = |what| DamagedRow { what, image: None };
        for table in TABLES {
            damaged.extend(table.damaged(&mut transaction).await?.into_iter().map(row));
        }
        damaged.extend(descriptions(&mut transaction).await?.into_iter().map(row));
        let images = Images::new(&self.columns);
        let mut last = i64::MIN;
        while let Some(end) = images.batch(&mut transaction, last, &mut damaged).await? {
            last = end;
        }
        for (table, sql) in WITHOUT_IMAGE {
            let alone: Vec<String> = sqlx::query_scalar(sql)
                .bind(MOST_FINDINGS)
                .fetch_all(&mut *transaction)
                .await?;
            damaged.extend(
                alone
                    .into_iter()
                    .map(|name| row(format!("{table} of {name}, which has no image"))),
            );
        }
        transaction.rollback().await?;
        connection.close().await?;
        Ok(damaged)
    }
}

const WITHOUT_IMAGE: [(&str, &str); 3] = [
    (
        "a record",
        "SELECT DISTINCT job_id || '/' || frame FROM records r WHERE job_id NOT IN (SELECT job_id FROM deletions)
             AND NOT EXISTS (SELECT 1 FROM images i WHERE i.job_id = r.job_id AND i.frame = r.frame) LIMIT ?",
    ),
    (
        "measurements",
        "SELECT DISTINCT job_id || '/' || frame FROM measurements r WHERE job_id NOT IN (SELECT job_id FROM deletions)
             AND NOT EXISTS (SELECT 1 FROM images i WHERE i.job_id = r.job_id AND i.frame = r.frame) LIMIT ?",
    ),
    (
        "artifacts",
        "SELECT DISTINCT job_id || '/' || frame FROM artifacts r WHERE job_id NOT IN (SELECT job_id FROM deletions)
             AND NOT EXISTS (SELECT 1 FROM images i WHERE i.job_id = r.job_id AND i.frame = r.frame) LIMIT ?",
    ),
];

async fn descriptions(connection: &mut SqliteConnection) -> Result<Vec<String>, CatalogueError> {
    let rows: Vec<(Vec<u8>, Vec<u8>, Vec<u8>)> = sqlx::query_as(
        "SELECT CAST(id AS BLOB), CAST(spec AS BLOB), CAST(spec_digest AS BLOB) FROM jobs ORDER BY id",
    )
    .fetch_all(connection)
    .await?;
    let mut damaged = Vec::new();
    for (id, spec, digest) in rows {
        let id = String::from_utf8_lossy(&id);
        let (spec, digest) = (std::str::from_utf8(&spec), std::str::from_utf8(&digest));
        let is_intact = matches!((spec, digest), (Ok(spec), Ok(digest)) if intact(&id, spec, digest).is_ok());
        if !is_intact {
            damaged.push(format!("the description of {id}"));
        }
    }
    Ok(damaged)
}

/// How images are read and compared.
struct Images {
    sql: String,
    /// Columns that follow the record.
    compared: Vec<(String, Column)>,
    metrics: Vec<String>,
}

impl Images {
    fn new(columns: &Columns) -> Self {
        let mut compared: Vec<(String, Column)> = Vec::new();
        for name in columns.names() {
            let column = columns.get(&name).filter(|column| column.join.is_none());
            let column = column.filter(|column| column.found.is_some());
            if let Some(column) = column
                && compared.iter().all(|(_, known)| *known != column)
            {
                compared.push((name, column));
            }
        }
        let selected: Vec<_> = columns
            .of_record()
            .iter()
            .chain(compared.iter().map(|(_, column)| column))
            .map(|column| column.sql.clone())
            .collect();
        let sql = format!(
            "SELECT {}, images.rowid FROM images LEFT JOIN records AS \"record of\"
                 ON \"record of\".job_id = images.job_id AND \"record of\".frame = images.frame
             WHERE images.rowid > ? ORDER BY images.rowid LIMIT {BATCH}",
            selected.join(", ")
        );
        Self {
            sql,
            compared,
            metrics: columns.metrics().to_vec(),
        }
    }

    /// Compares some images; returns the last of them.
    async fn batch(
        &self,
        connection: &mut SqliteConnection,
        after: i64,
        damaged: &mut Vec<DamagedRow>,
    ) -> Result<Option<i64>, CatalogueError> {
        let rows = sqlx::query(AssertSqlSafe(self.sql.as_str()))
            .bind(after)
            .fetch_all(&mut *connection)
            .await?;
        let Some(last) = rows.last() else { return Ok(None) };
        let last: i64 = last.try_get(last.len() - 1)?;
        let beside = self.beside(connection, after, last).await?;
        let deleted: Vec<String> = sqlx::query_scalar("SELECT job_id FROM deletions WHERE job_id > ''")
            .fetch_all(connection)
            .await?;
        for row in &rows {
            let Some(what) = self.difference(row, &beside) else {
                continue;
            };
            let image = row
                .try_get::<String, _>(0)
                .ok()
                .zip(row.try_get::<i64, _>(1).ok());
            if image.as_ref().is_some_and(|(job, _)| deleted.contains(job)) {
                continue;
            }
            damaged.push(DamagedRow {
                what,
                image: image.map(|(job, frame)| (job, frame as u64)),
            });
        }
        Ok(Some(last))
    }

    /// The first thing that is not as it was written.
    fn difference(&self, row: &SqliteRow, beside: &Beside) -> Option<String> {
        let verified = About::verified(row).and_then(|(about, record)| {
            let record: Value = serde_json::from_str(record)?;
            Ok((about, record))
        });
        let (about, record) = match verified {
            Ok(verified) => verified,
            Err(CatalogueError::Damaged { what, .. }) => return Some(what),
            Err(error) => return Some(error.to_string()),
        };
        let name = format!("{}/{}", about.job, about.frame);
        for (at, (column_name, column)) in self.compared.iter().enumerate() {
            let found = column.found.as_ref().map(|found| found.read(&record));
            if value(row, at + 7, column.kind).ok() != found {
                return Some(format!("column `{column_name}` of image {name}"));
            }
        }
        let key = (about.job.to_owned(), about.frame);
        let measured = beside.measured.get(&key);
        let subjects = record["measurements"].as_object();
        let subjects_match = subjects.map_or(0, serde_json::Map::len) == measured.map_or(0, BTreeMap::len);
        for (subject, values) in measured.into_iter().flatten() {
            let known = subjects.is_some_and(|subjects| subjects.contains_key(subject));
            if !known
                || self
                    .metrics
                    .iter()
                    .zip(values)
                    .any(|(metric, value): (&String, &Value)| {
                        let (subject, metric) = (subject.clone(), metric.clone());
                        RecordValue::Metric { subject, metric }.read(&record) != *value
                    })
            {
                return Some(format!("metrics of `{subject}` of image {name}"));
            }
        }
        if !subjects_match {
            return Some(format!("metrics of image {name}"));
        }
        let mut artifacts = record["artifacts"].as_array().cloned().unwrap_or_default();
        artifacts.sort_by_key(|entry| entry["kind"].as_str().map(str::to_owned));
        if beside.artifacts.get(&key).cloned().unwrap_or_default() != artifacts {
            return Some(format!("artifacts of image {name}"));
        }
        None
    }

    async fn beside(
        &self,
        connection: &mut SqliteConnection,
        after: i64,
        last: i64,
    ) -> Result<Beside, CatalogueError> {
        let mut beside = Beside::default();
        let names: String = self.metrics.iter().map(|name| format!(", \"{name}\"")).collect();
        let measured = format!(
            "SELECT job_id, frame, CAST(subject AS BLOB){names} FROM images CROSS JOIN measurements USING (job_id, frame)
             WHERE images.rowid > ? AND images.rowid <= ?"
        );
        let rows = sqlx::query(AssertSqlSafe(measured))
            .bind(after)
            .bind(last)
            .fetch_all(&mut *connection)
            .await?;
        for row in &rows {
            let values = (0..self.metrics.len()).map(|at| value(row, at + 3, Kind::Number));
            let subject = String::from_utf8_lossy(row.try_get(2)?).into_owned();
            let of_image = beside
                .measured
                .entry((row.try_get(0)?, row.try_get(1)?))
                .or_default();
            of_image.insert(subject, values.collect::<Result<_, _>>()?);
        }
        let rows: Vec<Artifact> = sqlx::query_as(
            "SELECT job_id, frame, CAST(kind AS BLOB), CAST(artifacts.digest AS BLOB), bytes, CAST(media_type AS BLOB)
             FROM images CROSS JOIN artifacts USING (job_id, frame)
             WHERE images.rowid > ? AND images.rowid <= ? ORDER BY kind",
        )
        .bind(after)
        .bind(last)
        .fetch_all(connection)
        .await?;
        for (job, frame, kind, digest, bytes, media_type) in rows {
            let [kind, digest, media_type] =
                [kind, digest, media_type].map(|text| String::from_utf8_lossy(&text).into_owned());
            beside
                .artifacts
                .entry((job, frame))
                .or_default()
                .push(serde_json::json!({
                    "kind": kind, "digest": digest, "bytes": bytes, "media_type": media_type
                }));
        }
        Ok(beside)
    }
}
