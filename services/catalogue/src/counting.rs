//! What is counted over a dataset: from the mirror where it has the rows, from the tables where it has not.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use client::CountedSource;
use columnar::{ColumnarError, Condition, Part, Question};
use sqlx::Connection;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::error::CatalogueError;
use crate::filter::Column;
use crate::gathering::gather;
use crate::mirror::{self, FileRow};
use crate::named::column;
use crate::select::Select;
use crate::versions::Scope;

/// Rows of the tables that are counted together.
const LOT: usize = 32_768;
/// How often a question begins anew because a file has gone meanwhile.
const ATTEMPTS: usize = 3;

/// A question over a dataset.
pub(crate) struct Asked<'a> {
    pub(crate) dataset: &'a str,
    pub(crate) columns: &'a [Column],
    pub(crate) filter: Option<&'a str>,
}

/// The rows of a question in one state of the catalogue.
struct Snapshot {
    files: Vec<(FileRow, HashSet<String>)>,
    /// Rows that no file holds.
    lots: Vec<Vec<columnar::Column>>,
}

impl Catalogue {
    /// Counts with the help of the mirror. `None`: it has no rows of the dataset, or lacks a column of the question, or `count`
    /// cannot: the tables have to be asked alone.
    pub(crate) async fn count<T: Send + 'static>(
        &self,
        asked: &Asked<'_>,
        count: impl Fn(&Question<'_>) -> Result<T, ColumnarError> + Send + Sync + 'static,
    ) -> Result<Option<T>, CatalogueError> {
        let names: Option<Vec<String>> = asked.columns.iter().map(|column| column.mirror.clone()).collect();
        let filter = Select::filter(&self.columns, asked.filter)?;
        let condition = filter.map(|filter| filter.condition);
        let (Some(names), false) = (names, condition == Some(None)) else {
            return Ok(None);
        };
        let (names, condition, count) = (Arc::new(names), Arc::new(condition.flatten()), Arc::new(count));
        for _ in 0..ATTEMPTS {
            let Some(snapshot) = within(self.snapshot(asked)).await? else {
                return Ok(None);
            };
            let (mirror, names, condition) = (
                Arc::clone(&self.mirror),
                Arc::clone(&names),
                Arc::clone(&condition),
            );
            let count = Arc::clone(&count);
            let counted = tokio::task::spawn_blocking(move || {
                let lots = snapshot.lots.into_iter();
                let mut parts: Vec<Part> = lots
                    .map(|lot| Part::Rows(lot.into_iter().map(Arc::new).collect()))
                    .collect();
                parts.extend(mirror.parts(snapshot.files)?);
                count(&Question {
                    parts: &parts,
                    columns: &names,
                    condition: Option::<Condition>::as_ref(&condition),
                    cache: &mirror.cache,
                    threads: mirror.threads,
                })
            });
            let counted = counted.await.map_err(|error| CatalogueError::Failed {
                message: error.to_string(),
            })?;
            match counted {
                Ok(counted) => return Ok(Some(counted)),
                Err(error) if error.file().is_some() => self.without_file(&error).await?,
                Err(ColumnarError::TooManyGroups(most)) => return Err(too_many_groups(most)),
                Err(_) => return Ok(None),
            }
        }
        Ok(None)
    }

    async fn snapshot(&self, asked: &Asked<'_>) -> Result<Option<Snapshot>, CatalogueError> {
        let mut reader = self.reader().await?;
        let mut state = reader.begin().await?;
        check_dataset(&mut state, asked.dataset).await?;
        let files = mirror::files(&mut state).await?;
        let mut jobs = jobs_of(&mut state, asked.dataset).await?;
        if jobs.is_empty() {
            return Ok(None);
        }
        let mut lots = Vec::new();
        for gap in mirror::gaps(&files) {
            let sql = Select::of_rows(
                &self.columns,
                asked.columns,
                asked.filter,
                Some(asked.dataset),
                gap,
            )?;
            lots.extend(gather(&mut state, &sql, asked.columns, LOT).await?);
        }
        state.rollback().await?;
        let files = files.into_iter().filter_map(|file| {
            let jobs = jobs.remove(&file.name)?;
            Some((file, jobs))
        });
        Ok(Some(Snapshot {
            files: files.collect(),
            lots,
        }))
    }

    /// Takes a file off the list that cannot be read: its rows are counted from the tables until they are written anew.
    async fn without_file(&self, error: &ColumnarError) -> Result<(), CatalogueError> {
        let name = error.file().and_then(|path| path.file_name());
        let name = name.unwrap_or_default().to_string_lossy().into_owned();
        let gone = self.forget_file(&name).await?;
        // What was replaced since is not at fault.
        if gone {
            tracing::warn!(%error, "a file of the mirror is written anew");
        }
        Ok(())
    }
}

/// The jobs of a dataset, or of a sealed version of it, by the file that has rows of them.
async fn jobs_of(
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
pub(crate) fn too_many_groups(most: usize) -> CatalogueError {
    let message = format!("`by` makes more than {most} groups: give wider bins, fewer columns or a filter");
    CatalogueError::refused(message)
}

/// A column of numbers by its name.
pub(crate) fn number_column(columns: &crate::columns::Columns, name: &str) -> Result<Column, CatalogueError> {
    let column = column(columns, name)?;
    if column.kind.is_number() {
        Ok(column)
    } else {
        Err(CatalogueError::refused(format!("`{name}` is no number")))
    }
}

pub(crate) async fn check_dataset(
    connection: &mut SqliteConnection,
    name: &str,
) -> Result<(), CatalogueError> {
    let scope = Scope::parse(name);
    let there = match scope.version {
        None => sqlx::query_scalar("SELECT 1 FROM datasets WHERE name = ?").bind(name),
        Some(version) => sqlx::query_scalar(
            "SELECT 1 FROM versions WHERE dataset = ? AND version = ? AND unsealed_ms IS NULL",
        )
        .bind(scope.dataset)
        .bind(version as i64),
    };
    let there: Option<i64> = there.fetch_optional(connection).await?;
    there
        .map(drop)
        .ok_or_else(|| CatalogueError::not_found("dataset", name))
}
