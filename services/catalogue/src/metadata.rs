//! The columns of a dataset, for tables of everything that is known about it.

use std::collections::BTreeSet;

use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::Kind;
use crate::types::ColumnInfo;

impl Catalogue {
    /// The columns of a dataset: those that every image has, its labels, the metrics of every picture that was
    /// measured, the digest of every kind of artifact. [`Catalogue::images`] with their names as fields gives whole
    /// rows, page by page.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn columns(&self, dataset: &str) -> Result<Vec<ColumnInfo>, CatalogueError> {
        let mut reader = self.reader().await?;
        let names = within(names(&mut reader, &self.columns, dataset)).await?;
        Ok(names
            .into_iter()
            .filter_map(|name| info(&self.columns, name))
            .collect())
    }
}

async fn names(
    connection: &mut SqliteConnection,
    columns: &Columns,
    dataset: &str,
) -> Result<Vec<String>, CatalogueError> {
    let labels: Vec<String> = sqlx::query_scalar(
        "SELECT DISTINCT label.key FROM jobs, json_each(jobs.spec, '$.labels') AS label
         WHERE dataset = ? AND jobs.id NOT IN (SELECT job_id FROM deletions) ORDER BY label.key",
    )
    .bind(dataset)
    .fetch_all(&mut *connection)
    .await?;
    let subjects: BTreeSet<String> = sqlx::query_scalar(
        "SELECT DISTINCT subject FROM measurements WHERE job_id IN
             (SELECT id FROM jobs WHERE dataset = ? AND id NOT IN (SELECT job_id FROM deletions))",
    )
    .bind(dataset)
    .fetch_all(&mut *connection)
    .await?
    .into_iter()
    .collect();
    let kinds: BTreeSet<String> = sqlx::query_scalar(
        "SELECT DISTINCT kind FROM artifacts WHERE job_id IN
             (SELECT id FROM jobs WHERE dataset = ? AND id NOT IN (SELECT job_id FROM deletions))",
    )
    .bind(dataset)
    .fetch_all(connection)
    .await?
    .into_iter()
    .collect();
    let mut names = columns.names();
    names.extend(labels.into_iter().map(|label| format!("labels.{label}")));
    for subject in subjects.iter().filter(|subject| *subject != "rgb") {
        names.extend(
            columns
                .metrics()
                .iter()
                .map(|metric| format!("{subject}.{metric}")),
        );
    }
    names.extend(kinds.into_iter().map(|kind| format!("artifacts.{kind}")));
    Ok(names)
}

fn info(columns: &Columns, name: String) -> Option<ColumnInfo> {
    let column = columns.get(&name)?;
    let kind = match column.kind {
        Kind::Number | Kind::Whole | Kind::Large => "number",
        Kind::Text => "text",
        Kind::Bool => "bool",
    };
    Some(ColumnInfo {
        unit: column.unit,
        name,
        kind,
    })
}
