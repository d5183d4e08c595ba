//! The columns of a dataset.

use client::ColumnInfo;
use std::collections::{BTreeMap, BTreeSet};

use spec::{LabelType, collect_types};
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::error::CatalogueError;
use crate::query::cache::{JobCache, Pictures};
use crate::query::columns::{Columns, measured_name};
use crate::query::filter::Kind;
use crate::query::scope::Scope;

impl Catalogue {
    /// The columns of a dataset: those of every image, its labels, the metrics of every measured picture, and the digest of every kind of
    /// artifact. [`Catalogue::images`] with these names as fields returns complete rows, page by page.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn columns(&self, dataset: &str) -> Result<Vec<ColumnInfo>, CatalogueError> {
        let mut reader = self.reader().await?;
        let names = within(names(&mut reader, &self.columns, &self.job_cache, dataset)).await?;
        Ok(names
            .into_iter()
            .filter_map(|named| info(&self.columns, named))
            .collect())
    }
}

/// The columns of the images of every dataset; labels, timings and artifacts depend on the dataset.
#[must_use]
pub fn columns_of_every_image(metrics: &[String]) -> Vec<ColumnInfo> {
    let columns = Columns::new(metrics);
    let names = columns.names();
    names
        .into_iter()
        .filter_map(|name| info(&columns, name.into()))
        .collect()
}

/// A column's name, and the types of a label's values.
struct Named {
    name: String,
    types: BTreeSet<LabelType>,
}

impl From<String> for Named {
    fn from(name: String) -> Self {
        Self {
            name,
            types: BTreeSet::new(),
        }
    }
}

/// The labels of a dataset with the types that their descriptions allow.
async fn labels(
    connection: &mut SqliteConnection,
    dataset: &str,
) -> Result<BTreeMap<String, BTreeSet<LabelType>>, CatalogueError> {
    let scope = Scope::parse(dataset);
    let rows: Vec<(String, String)> = sqlx::query_as(
        "SELECT DISTINCT label.key, jobs.spec -> label.fullkey FROM jobs, json_each(jobs.spec, '$.labels') AS label
         WHERE dataset = ?1 AND jobs.id NOT IN (SELECT job_id FROM deletions)
           AND (?2 IS NULL OR jobs.id IN (SELECT job_id FROM version_jobs WHERE dataset = ?1 AND version = ?2))",
    )
    .bind(scope.dataset)
    .bind(scope.version.map(|version| version as i64))
    .fetch_all(connection)
    .await?;
    let mut labels: BTreeMap<String, BTreeSet<LabelType>> = BTreeMap::new();
    for (label, description) in rows {
        let types = labels.entry(label).or_default();
        collect_types(&serde_json::from_str(&description)?, types);
    }
    Ok(labels)
}

/// The metrics of networks that the jobs of a dataset name, such as `net.NAME`.
async fn metric_networks(
    connection: &mut SqliteConnection,
    dataset: &str,
) -> Result<BTreeSet<String>, CatalogueError> {
    let scope = Scope::parse(dataset);
    let named: Vec<String> = sqlx::query_scalar(
        "SELECT DISTINCT metric.value FROM jobs, json_tree(jobs.spec) AS metric
         WHERE dataset = ?1 AND jobs.id NOT IN (SELECT job_id FROM deletions) AND instr(jobs.spec, '\"net.') > 0
           AND (?2 IS NULL OR jobs.id IN (SELECT job_id FROM version_jobs WHERE dataset = ?1 AND version = ?2))
           AND metric.type = 'text' AND metric.value GLOB 'net.*' AND metric.path GLOB '*.metrics*'",
    )
    .bind(scope.dataset)
    .bind(scope.version.map(|version| version as i64))
    .fetch_all(connection)
    .await?;
    Ok(named.into_iter().collect())
}

async fn names(
    connection: &mut SqliteConnection,
    columns: &Columns,
    job_cache: &JobCache,
    dataset: &str,
) -> Result<Vec<Named>, CatalogueError> {
    let labels = labels(connection, dataset).await?;
    let (subjects, kinds) = pictures(connection, job_cache, dataset).await?;
    let mut names: Vec<Named> = columns.names().into_iter().map(Named::from).collect();
    names.extend(labels.into_iter().map(|(label, types)| Named {
        name: format!("labels.{label}"),
        types,
    }));
    for subject in subjects.iter().filter(|subject| *subject != "rgb") {
        let metrics = columns.metrics().iter();
        names.extend(metrics.map(|metric| Named::from(format!("{subject}.{metric}"))));
    }
    for network in metric_networks(connection, dataset).await? {
        let measured = subjects.iter().map(|subject| measured_name(subject, &network));
        names.extend(measured.map(Named::from));
    }
    names.extend(
        kinds
            .into_iter()
            .map(|kind| Named::from(format!("artifacts.{kind}"))),
    );
    Ok(names)
}

/// The pictures and kinds of a dataset or a version of it.
async fn pictures(
    connection: &mut SqliteConnection,
    job_cache: &JobCache,
    dataset: &str,
) -> Result<Pictures, CatalogueError> {
    let scope = Scope::parse(dataset);
    let jobs = sqlx::query_as(
        "SELECT id, version FROM jobs WHERE dataset = ?1 AND frames >= ?3 AND id NOT IN (SELECT job_id FROM deletions)
            AND (?2 IS NULL OR id IN (SELECT job_id FROM version_jobs WHERE dataset = ?1 AND version = ?2))",
    );
    let jobs = jobs
        .bind(scope.dataset)
        .bind(scope.version.map(|version| version as i64));
    let jobs: Vec<(String, i64)> = jobs
        .bind(JobCache::LEAST_FRAMES)
        .fetch_all(&mut *connection)
        .await?;
    let (mut subjects, mut kinds) = of_small_jobs(connection, dataset).await?;
    for (job, version) in jobs {
        let found = match job_cache.get(&job, version) {
            Some(found) => found,
            None => {
                let found = of_job(connection, &job).await?;
                job_cache.keep(job, version, found.clone());
                found
            }
        };
        subjects.extend(found.0);
        kinds.extend(found.1);
    }
    Ok((subjects, kinds))
}

async fn of_small_jobs(connection: &mut SqliteConnection, dataset: &str) -> Result<Pictures, CatalogueError> {
    let subjects = distinct(
        connection,
        dataset,
        "SELECT DISTINCT subject FROM measurements WHERE job_id IN
             (SELECT id FROM jobs WHERE dataset = ?1 AND frames < ?3 AND id NOT IN (SELECT job_id FROM deletions)
                 AND (?2 IS NULL OR id IN (SELECT job_id FROM version_jobs WHERE dataset = ?1 AND version = ?2)))",
    );
    let subjects = subjects.await?;
    let kinds = distinct(
        connection,
        dataset,
        "SELECT DISTINCT kind FROM artifacts WHERE job_id IN
             (SELECT id FROM jobs WHERE dataset = ?1 AND frames < ?3 AND id NOT IN (SELECT job_id FROM deletions)
                 AND (?2 IS NULL OR id IN (SELECT job_id FROM version_jobs WHERE dataset = ?1 AND version = ?2)))",
    );
    Ok((subjects, kinds.await?))
}

async fn of_job(connection: &mut SqliteConnection, job: &str) -> Result<Pictures, CatalogueError> {
    let subjects: Vec<String> =
        sqlx::query_scalar("SELECT DISTINCT subject FROM measurements WHERE job_id = ?")
            .bind(job)
            .fetch_all(&mut *connection)
            .await?;
    let kinds: Vec<String> = sqlx::query_scalar("SELECT DISTINCT kind FROM artifacts WHERE job_id = ?")
        .bind(job)
        .fetch_all(connection)
        .await?;
    Ok((subjects.into_iter().collect(), kinds.into_iter().collect()))
}

/// The names that a statement finds in a dataset or a version of it, in order.
async fn distinct(
    connection: &mut SqliteConnection,
    dataset: &str,
    sql: &'static str,
) -> Result<BTreeSet<String>, CatalogueError> {
    let scope = Scope::parse(dataset);
    let names = sqlx::query_scalar(sql).bind(scope.dataset);
    let names = names.bind(scope.version.map(|version| version as i64));
    let names = names.bind(JobCache::LEAST_FRAMES);
    let names: Vec<String> = names.fetch_all(connection).await?;
    Ok(names.into_iter().collect())
}

fn info(columns: &Columns, Named { name, types }: Named) -> Option<ColumnInfo> {
    let column = columns.get(&name)?;
    let kind = match column.kind {
        Kind::Number | Kind::Whole | Kind::Large => "number",
        Kind::Text => "text",
        Kind::Bool => "bool",
        Kind::Label => match types.first().filter(|_| types.len() == 1) {
            Some(only) => only.name(),
            None => "mixed",
        },
    };
    Some(ColumnInfo {
        unit: column.unit.map(str::to_owned),
        name,
        kind: kind.to_owned(),
    })
}
