//! Storing images: rows with wide parameter columns, records, measurements, artifact names and counters, all or nothing.
//!
//! Many images share a statement, since passing a statement to SQLite costs more than running it: 300 us per image one by one.

use std::collections::{BTreeMap, HashSet};

use futures::future::join;
use serde_json::json;
use spec::{ArtifactEntry, FrameRecord, RecordOf, RecordText};
use sqlx::AssertSqlSafe;
use sqlx::sqlite::SqliteConnection;

use crate::commit::deliveries::insert_delivery;
use crate::commit::progress;
use crate::digests::record_row::About;
use crate::error::CatalogueError;
use crate::query::cells::{Statement, bound};
use crate::query::columns::Columns;
use crate::query::filter::Bind;
use crate::types::{Delivery, InsertImage};

/// Rows of one statement: few sizes, so that SQLite keeps every statement prepared.
const ROWS: [usize; 4] = [64, 16, 4, 1];
/// From this number of images on, the columns that none of them has are left out of the statement. Smaller groups would have many
/// different sets of columns, each with a statement of its own.
const MANY: usize = 64;

/// An image prepared for insertion, before the writer needs it.
pub struct NewImage {
    pub(crate) job: String,
    pub(crate) frame: i64,
    digest: String,
    record: String,
    /// SHA-256 of the record.
    record_digest: String,
    /// Of the wide columns, in their order.
    parameters: Vec<Option<Bind>>,
    /// Of each subject, in the order of the metrics. One that the catalogue does not know stays in the record only.
    measurements: Vec<(String, Vec<Option<f64>>)>,
    pub(crate) artifacts: Vec<NewArtifact>,
    warnings: i64,
    now_ms: u64,
    /// `None`: the service trusts its worker.
    delivery: Option<Delivery>,
}

/// An artifact of such an image.
pub(crate) struct NewArtifact {
    pub(crate) entry: ArtifactEntry,
    /// Where it begins in the tar of its shard; `None`: it is in the packs.
    pub(crate) offset: Option<i64>,
}

impl NewImage {
    pub(crate) fn new(
        columns: &Columns,
        job: &str,
        record: &FrameRecord,
        now_ms: u64,
        offsets: &BTreeMap<String, u64>,
    ) -> Result<Self, CatalogueError> {
        let json = serde_json::to_value(record)?;
        let text = json.to_string();
        Ok(Self {
            job: job.to_owned(),
            frame: record.frame as i64,
            digest: record.digest(),
            record_digest: spec::sha256(text.as_bytes()),
            record: text,
            parameters: columns.stored_values(&json)?,
            measurements: measurements(columns, record),
            artifacts: artifacts(record, offsets),
            warnings: record.warnings.len() as i64,
            now_ms,
            delivery: None,
        })
    }

    /// The same of a record that is there as text.
    pub(crate) fn imported(
        columns: &Columns,
        job: &str,
        text: &RecordText,
        now_ms: u64,
        offsets: &BTreeMap<String, u64>,
    ) -> Result<Self, CatalogueError> {
        let record = text.record();
        Ok(Self {
            job: job.to_owned(),
            frame: record.frame as i64,
            digest: text.digest().to_owned(),
            record_digest: spec::sha256(text.as_str().as_bytes()),
            record: text.as_str().to_owned(),
            parameters: columns.stored_values(&mut serde_json::Deserializer::from_str(text.as_str()))?,
            measurements: measurements(columns, record),
            artifacts: artifacts(record, offsets),
            warnings: record.warnings.len() as i64,
            now_ms,
            delivery: None,
        })
    }

    /// The same from a worker that the service does not trust.
    pub(crate) fn with_delivery(self, delivery: Option<Delivery>) -> Self {
        Self { delivery, ..self }
    }

    fn bytes(&self) -> u64 {
        self.artifacts.iter().map(|artifact| artifact.entry.bytes).sum()
    }
}

/// Of each subject of a record, its values in the order of the metrics.
fn measurements<V, M>(columns: &Columns, record: &RecordOf<V, M>) -> Vec<(String, Vec<Option<f64>>)> {
    let metrics = columns.metrics();
    let measured = record.measurements.iter().map(|(subject, values)| {
        let values = metrics.iter().map(|metric| values.get(metric).copied());
        (subject.clone(), values.collect())
    });
    measured.collect()
}

/// The artifacts of a record, with their places in the tar by kind.
fn artifacts<V, M>(record: &RecordOf<V, M>, offsets: &BTreeMap<String, u64>) -> Vec<NewArtifact> {
    let artifacts = record.artifacts.iter().map(|entry| NewArtifact {
        entry: entry.clone(),
        offset: offsets.get(&entry.kind).map(|&offset| offset as i64),
    });
    artifacts.collect()
}

/// The state of a frame before its image is stored: the dataset of its job, and whether it has an image, was abandoned, or belongs
/// to a sealed job.
type Known = (Option<String>, bool, bool, bool);

/// Stores images and returns what became of each.
pub(crate) async fn insert(
    connection: &mut SqliteConnection,
    columns: &Columns,
    images: &[&NewImage],
) -> Result<Vec<Result<InsertImage, CatalogueError>>, CatalogueError> {
    let known = known(connection, images).await?;
    let mut first = HashSet::new();
    let mut answers = Vec::with_capacity(images.len());
    let mut new = Vec::with_capacity(images.len());
    for (&image, (dataset, there, was_given_up, is_sealed)) in images.iter().zip(known) {
        answers.push(match dataset {
            None => Err(CatalogueError::not_found("job", &image.job)),
            Some(_) if there || !first.insert((&image.job, image.frame)) => Ok(InsertImage::AlreadyThere),
            Some(_) if is_sealed => Err(CatalogueError::Sealed {
                job: image.job.clone(),
                version: "a version of its dataset".to_owned(),
            }),
            Some(dataset) => {
                new.push((image, dataset, was_given_up));
                Ok(InsertImage::Inserted)
            }
        });
    }
    insert_rows(connection, columns, &new).await?;
    count(connection, &new).await?;
    Ok(answers)
}

async fn known(
    connection: &mut SqliteConnection,
    images: &[&NewImage],
) -> Result<Vec<Known>, CatalogueError> {
    let requested: Vec<_> = images
        .iter()
        .map(|image| json!([image.job, image.frame]))
        .collect();
    let known = sqlx::query_as(
        "SELECT jobs.dataset,
                EXISTS (SELECT 1 FROM images WHERE job_id = jobs.id AND frame = requested.value ->> 1),
                EXISTS (SELECT 1 FROM failures WHERE job_id = jobs.id AND frame = requested.value ->> 1 AND quarantined = 1),
                EXISTS (SELECT 1 FROM version_jobs WHERE job_id = jobs.id)
         FROM json_each(?) requested LEFT JOIN jobs
              ON jobs.id = requested.value ->> 0 AND jobs.id NOT IN (SELECT job_id FROM deletions)
         ORDER BY requested.key",
    );
    Ok(known
        .bind(json!(requested).to_string())
        .fetch_all(connection)
        .await?)
}

pub(crate) async fn insert_rows(
    connection: &mut SqliteConnection,
    columns: &Columns,
    new: &[(&NewImage, String, bool)],
) -> Result<(), CatalogueError> {
    let has_value = |column: usize| new.iter().any(|(image, ..)| image.parameters[column].is_some());
    let (used, names): (Vec<usize>, Vec<String>) = columns
        .stored_names()
        .enumerate()
        .filter(|(column, _)| new.len() < MANY || has_value(*column))
        .map(|(column, name)| (column, format!(", \"{name}\"")))
        .unzip();
    let names = names.concat();
    let head = format!("INSERT INTO images (job_id, frame, dataset, created_ms, digest, warnings{names})");
    let width = 6 + used.len();
    insert_all(connection, &head, width, new, |statement, (image, dataset, _)| {
        let fixed = statement
            .bind(&image.job)
            .bind(image.frame)
            .bind(dataset)
            .bind(image.now_ms as i64)
            .bind(&image.digest)
            .bind(image.warnings);
        used.iter().fold(fixed, |statement, &column| {
            bound(statement, image.parameters[column].as_ref())
        })
    })
    .await?;

    let head = "INSERT INTO records (job_id, frame, record, row_digest)";
    insert_all(connection, head, 4, new, |statement, (image, dataset, _)| {
        let about = About {
            job: &image.job,
            frame: image.frame,
            dataset,
            created_ms: image.now_ms as i64,
            digest: &image.digest,
        };
        let fixed = statement.bind(&image.job).bind(image.frame).bind(&image.record);
        fixed.bind(about.row_digest(&image.record_digest))
    })
    .await?;

    let measured: Vec<_> = new
        .iter()
        .flat_map(|(image, ..)| image.measurements.iter().map(move |measured| (image, measured)))
        .collect();
    let has_value = |metric: usize| measured.iter().any(|(_, (_, values))| values[metric].is_some());
    let (used, names): (Vec<usize>, Vec<String>) = columns
        .metrics()
        .iter()
        .enumerate()
        .filter(|(metric, _)| new.len() < MANY || has_value(*metric))
        .map(|(metric, name)| (metric, format!(", \"{name}\"")))
        .unzip();
    let head = format!(
        "INSERT INTO measurements (job_id, frame, subject{})",
        names.concat()
    );
    let width = 3 + used.len();
    insert_all(
        connection,
        &head,
        width,
        &measured,
        |statement, (image, (subject, values))| {
            let fixed = statement.bind(&image.job).bind(image.frame).bind(subject);
            used.iter()
                .fold(fixed, |statement, &metric| statement.bind(values[metric]))
        },
    )
    .await?;

    let head = "INSERT INTO artifacts (job_id, frame, kind, digest, bytes, media_type, tar_offset)";
    let artifacts: Vec<_> = new
        .iter()
        .flat_map(|(image, ..)| image.artifacts.iter().map(move |artifact| (image, artifact)))
        .collect();
    insert_all(connection, head, 7, &artifacts, |statement, (image, artifact)| {
        let NewArtifact { entry, offset } = artifact;
        statement
            .bind(&image.job)
            .bind(image.frame)
            .bind(&entry.kind)
            .bind(&entry.digest)
            .bind(entry.bytes as i64)
            .bind(&entry.media_type)
            .bind(*offset)
    })
    .await
}

/// Inserts rows of `width` values, several per statement. The values of the next statement are prepared while SQLite runs one in its
/// thread.
async fn insert_all<R>(
    connection: &mut SqliteConnection,
    head: &str,
    width: usize,
    mut rows: &[R],
    bind: impl for<'q> Fn(Statement<'q>, &'q R) -> Statement<'q>,
) -> Result<(), CatalogueError> {
    let places = format!("({})", vec!["?"; width].join(", "));
    let mut gather = || {
        let &most = ROWS.iter().find(|&&most| most <= rows.len())?;
        let (some, rest) = rows.split_at(most);
        rows = rest;
        let sql = format!("{head} VALUES {}", vec![places.as_str(); most].join(", "));
        Some(
            some.iter()
                .fold(sqlx::query(AssertSqlSafe(sql)), |statement, row| {
                    bind(statement, row)
                }),
        )
    };
    let mut statement = gather();
    while let Some(ready) = statement {
        let (done, next) = join(ready.execute(&mut *connection), async { gather() }).await;
        done?;
        statement = next;
    }
    Ok(())
}

/// Brings the counters of jobs and datasets in line with new images.
async fn count(
    connection: &mut SqliteConnection,
    new: &[(&NewImage, String, bool)],
) -> Result<(), CatalogueError> {
    let mut jobs: BTreeMap<&str, progress::Added> = BTreeMap::new();
    for (image, dataset, was_given_up) in new {
        if *was_given_up {
            sqlx::query("UPDATE failures SET quarantined = 0 WHERE job_id = ? AND frame = ?")
                .bind(&image.job)
                .bind(image.frame)
                .execute(&mut *connection)
                .await?;
        }
        let added = jobs.entry(&image.job).or_insert_with(|| progress::Added {
            dataset: dataset.clone(),
            first_ms: image.now_ms,
            ..progress::Added::default()
        });
        added.images += 1;
        if let Some(delivery) = &image.delivery {
            insert_delivery(connection, &image.job, image.frame, delivery).await?;
            added.deliveries += 1;
        }
        added.given_up += i64::from(*was_given_up);
        added.bytes += image.bytes() as i64;
        added.first_ms = added.first_ms.min(image.now_ms);
        added.last_ms = added.last_ms.max(image.now_ms);
    }
    for (job, added) in jobs {
        progress::count_images(connection, job, &added).await?;
    }
    Ok(())
}
