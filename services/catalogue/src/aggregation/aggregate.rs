//! Aggregation over the images of a dataset: files of the columnar replica, and rows of the tables that are in no file.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, LazyLock};

use client::CountedSource;
use columnar::{ColumnarError, Condition, Part, Query};
use prometheus::{IntCounter, register_int_counter};
use sqlx::Connection;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::error::CatalogueError;
use crate::query::column_value::column;
use crate::query::filter::{Column, Kind};
use crate::query::scope::Scope;
use crate::query::select::Select;
use crate::replica::files as replica_files;
use crate::replica::files::FileRow;
use crate::replica::parts::gather;

/// Rows of a part in memory.
const PART_ROWS: usize = 32_768;
/// Attempts at a query while files of the replica disappear or are damaged.
const ATTEMPTS: usize = 3;

/// Aggregations that had to be repeated because of a fault of the replica.
static FAULTS: LazyLock<IntCounter> = LazyLock::new(|| {
    register_int_counter!(
        "fathom_replica_faults_total",
        "Faults of the columnar replica during queries, after which its rows were read from the tables"
    )
    .expect("the name is valid and unique")
});

/// Images of a dataset, and the columns that an aggregation needs of them.
pub(crate) struct ImageSet<'a> {
    pub(crate) dataset: &'a str,
    pub(crate) columns: &'a [Column],
    pub(crate) filter: Option<&'a str>,
}

/// A query in the terms of the replica.
struct ReplicaQuery {
    columns: Vec<String>,
    condition: Option<Condition>,
}

/// All rows of a query in one state of the catalogue.
struct Snapshot {
    files: Vec<(FileRow, HashSet<String>)>,
    /// Rows that are in no file.
    memory: Vec<Part>,
}

impl Catalogue {
    /// Aggregates images: those in files of the replica, and the rest from the tables as parts in memory. All are from the tables if
    /// the replica lacks a column of the query, or after repeated faults of its files.
    pub(crate) async fn aggregate<T: Send + 'static>(
        &self,
        images: &ImageSet<'_>,
        aggregate: impl Fn(&Query<'_>) -> Result<T, ColumnarError> + Send + Sync + 'static,
    ) -> Result<T, CatalogueError> {
        let query = self.replica_query(images)?;
        let is_in_replica = query.is_some();
        let query = query.unwrap_or_else(|| ReplicaQuery {
            columns: vec![String::new(); images.columns.len()],
            condition: None,
        });
        let (query, aggregate) = (Arc::new(query), Arc::new(aggregate));
        for attempt in 0..=ATTEMPTS {
            let with_replica = is_in_replica && attempt < ATTEMPTS;
            let snapshot = within(self.snapshot(images, with_replica)).await?;
            let (replica, query, aggregate) = (
                Arc::clone(&self.replica),
                Arc::clone(&query),
                Arc::clone(&aggregate),
            );
            let aggregated = tokio::task::spawn_blocking(move || {
                let mut parts = snapshot.memory;
                parts.extend(replica.parts(snapshot.files)?);
                aggregate(&Query {
                    parts: &parts,
                    columns: &query.columns,
                    condition: query.condition.as_ref(),
                    cache: &replica.cache,
                    threads: replica.threads,
                })
            });
            match aggregated.await.map_err(failed)? {
                Ok(aggregated) => return Ok(aggregated),
                Err(ColumnarError::TooManyGroups(most)) => return Err(too_many_groups(most)),
                Err(error) if error.file().is_some() => self.drop_faulty_file(&error).await?,
                Err(error) => return Err(failed(error)),
            }
        }
        Err(failed(
            "the files of the replica changed during every attempt at the query",
        ))
    }

    /// Whether the replica has all columns of a query and of its filter.
    pub(crate) fn is_in_replica(&self, images: &ImageSet<'_>) -> Result<bool, CatalogueError> {
        Ok(self.replica_query(images)?.is_some())
    }

    fn replica_query(&self, images: &ImageSet<'_>) -> Result<Option<ReplicaQuery>, CatalogueError> {
        let columns: Option<Vec<String>> = images
            .columns
            .iter()
            .map(|column| column.replica_name.clone())
            .collect();
        let condition = match Select::filter(&self.columns, images.filter)? {
            Some(filter) => match filter.condition {
                Some(condition) => Some(condition),
                None => return Ok(None),
            },
            None => None,
        };
        Ok(columns.map(|columns| ReplicaQuery { columns, condition }))
    }

    async fn snapshot(&self, images: &ImageSet<'_>, with_replica: bool) -> Result<Snapshot, CatalogueError> {
        let mut reader = self.reader().await?;
        let mut state = reader.begin().await?;
        check_dataset(&mut state, images.dataset).await?;
        let (columns, dataset) = (images.columns, Some(images.dataset));
        let mut jobs = match with_replica {
            true => jobs_by_file(&mut state, images.dataset).await?,
            false => HashMap::new(),
        };
        let mut selects = Vec::new();
        let mut files = Vec::new();
        if jobs.is_empty() {
            selects.push(Select::new(&self.columns, columns, images.filter, dataset)?);
        } else {
            let all = replica_files::list_files(&mut state).await?;
            for gap in replica_files::uncovered_rows(&all) {
                selects.push(Select::of_rows(
                    &self.columns,
                    columns,
                    images.filter,
                    dataset,
                    gap,
                )?);
            }
            files.extend(all.into_iter().filter_map(|file| {
                let jobs = jobs.remove(&file.name)?;
                Some((file, jobs))
            }));
        }
        let mut memory = Vec::new();
        for select in &selects {
            let lots = gather(&mut state, select, columns, PART_ROWS).await?;
            let lots = lots
                .into_iter()
                .map(|lot| lot.into_iter().map(Arc::new).collect());
            memory.extend(lots.map(Part::Rows));
        }
        state.rollback().await?;
        Ok(Snapshot { files, memory })
    }

    /// Removes a file that cannot be read from the list of the replica; its rows are read from the tables until they are written
    /// again.
    async fn drop_faulty_file(&self, error: &ColumnarError) -> Result<(), CatalogueError> {
        FAULTS.inc();
        let name = error.file().and_then(|path| path.file_name());
        let name = name.unwrap_or_default().to_string_lossy().into_owned();
        let was_listed = self.forget_file(&name).await?;
        // A file that was replaced meanwhile needs no warning.
        if was_listed {
            tracing::warn!(%error, "a file of the replica cannot be read and is written again");
        }
        Ok(())
    }
}

fn failed(error: impl std::fmt::Display) -> CatalogueError {
    CatalogueError::Failed {
        message: error.to_string(),
    }
}

/// The jobs of a dataset, or of a sealed version of it, by the files that have rows of them.
async fn jobs_by_file(
    connection: &mut SqliteConnection,
    dataset: &str,
) -> Result<HashMap<String, HashSet<String>>, CatalogueError> {
    let scope = Scope::parse(dataset);
    let rows: Vec<(String, String)> = sqlx::query_as(
        "SELECT file, job_id FROM mirror_jobs WHERE job_id IN
             (SELECT id FROM jobs WHERE dataset = ?1 AND id NOT IN (SELECT job_id FROM deletions)
                 AND (?2 IS NULL OR id IN (SELECT job_id FROM version_jobs WHERE dataset = ?1 AND version = ?2)))",
    )
    .bind(scope.dataset)
    .bind(scope.version.map(|version| version as i64))
    .fetch_all(connection)
    .await?;
    let mut jobs: HashMap<String, HashSet<String>> = HashMap::new();
    for (file, job) in rows {
        jobs.entry(file).or_default().insert(job);
    }
    Ok(jobs)
}

/// The source of a count, as the API names it.
pub(crate) fn counted_source(source: columnar::Source) -> CountedSource {
    CountedSource {
        mirror: source.files,
        catalogue: source.memory,
    }
}

/// The error for more groups than a table should have.
fn too_many_groups(most: usize) -> CatalogueError {
    let message = format!("makes more than {most} groups: use wider bins, fewer columns or a filter");
    CatalogueError::refused_parameter("by", &message)
}

/// A column of numbers that a parameter names.
pub(crate) fn number_column(
    columns: &crate::query::columns::Columns,
    name: &str,
    parameter: &'static str,
) -> Result<Column, CatalogueError> {
    let column = column(columns, name, parameter)?.typed(Kind::Number);
    if column.kind.is_number() {
        Ok(column)
    } else {
        let message = format!("names `{name}`, which is not a column of numbers");
        Err(CatalogueError::refused_parameter(parameter, &message))
    }
}

pub(crate) async fn check_dataset(
    connection: &mut SqliteConnection,
    name: &str,
) -> Result<(), CatalogueError> {
    let scope = Scope::parse(name);
    let statement = match scope.version {
        None => sqlx::query_scalar("SELECT 1 FROM datasets WHERE name = ?").bind(name),
        Some(version) => sqlx::query_scalar(
            "SELECT 1 FROM versions WHERE dataset = ? AND version = ? AND unsealed_ms IS NULL",
        )
        .bind(scope.dataset)
        .bind(version as i64),
    };
    let exists: Option<i64> = statement.fetch_optional(connection).await?;
    exists
        .map(drop)
        .ok_or_else(|| CatalogueError::not_found("dataset", name))
}
