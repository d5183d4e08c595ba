//! Removes untrusted images, so that their frames are rendered again.

use serde_json::json;
use sqlx::AssertSqlSafe;
use sqlx::sqlite::SqliteConnection;

use super::proofs;
use super::rows::{imported, known_job, row};
use crate::catalogue::Catalogue;
use crate::datasets::versions::refuse_sealed;
use crate::digests::tables::job_columns;
use crate::error::CatalogueError;
use crate::replica::files as replica_files;
use crate::types::Retried;

/// Tables with rows of a frame's image, without `images`.
const BESIDE: [&str; 4] = ["artifacts", "measurements", "records", "deliveries"];
/// Which rows: of this job and these frames.
const WHERE: &str = "WHERE job_id = ?1 AND frame IN (SELECT value FROM json_each(?2))";

impl Catalogue {
    /// Removes the images of some frames of a job with the references to their bytes. An ended job is opened again, unless it was
    /// cancelled. Returns the frames that had an image; the caller offers them to workers.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Sealed`]; [`CatalogueError::Imported`].
    pub async fn reopen(&self, id: &str, frames: Vec<u64>) -> Result<Retried, CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { reopen(c, &id, &frames).await }))
            .await
    }
}

pub(super) async fn reopen(
    connection: &mut SqliteConnection,
    id: &str,
    frames: &[u64],
) -> Result<Retried, CatalogueError> {
    let job = known_job(connection, id).await?;
    if job.set.is_some() {
        return Err(imported(job));
    }
    refuse_sealed(connection, id).await?;
    let list = json!(frames).to_string();
    let sql = format!("SELECT coalesce(sum(bytes), 0) FROM artifacts {WHERE}");
    let bytes: i64 = sqlx::query_scalar(AssertSqlSafe(sql))
        .bind(id)
        .bind(&list)
        .fetch_one(&mut *connection)
        .await?;
    let orphans = format!("INSERT OR IGNORE INTO orphans (digest) SELECT digest FROM artifacts {WHERE}");
    let removals = BESIDE.map(|table| format!("DELETE FROM {table} {WHERE}"));
    for sql in std::iter::once(orphans).chain(removals) {
        let statement = sqlx::query(AssertSqlSafe(sql)).bind(id).bind(&list);
        statement.execute(&mut *connection).await?;
    }
    let sql = format!("DELETE FROM images {WHERE} RETURNING frame");
    let mut gone: Vec<i64> = sqlx::query_scalar(AssertSqlSafe(sql))
        .bind(id)
        .bind(&list)
        .fetch_all(&mut *connection)
        .await?;
    gone.sort_unstable();
    replica_files::drop_changed_rows(connection, id).await?;
    sqlx::query("UPDATE datasets SET images = images - ?, bytes = bytes - ? WHERE name = ?")
        .bind(gone.len() as i64)
        .bind(bytes)
        .bind(&job.dataset)
        .execute(&mut *connection)
        .await?;
    proofs::count_unproven(connection, id).await?;
    let changed = sqlx::query(concat!(
        "UPDATE jobs SET done = done - ?2, bytes = bytes - ?3, version = version + 1, digest = NULL, finished_ms = NULL,
                         state = CASE WHEN state IN ('done', 'done_with_failures') THEN 'running' ELSE state END
         WHERE id = ?1 RETURNING ",
        job_columns!(),
    ))
    .bind(id)
    .bind(gone.len() as i64)
    .bind(bytes)
    .fetch_one(connection)
    .await?;
    Ok(Retried {
        job: row(&changed)?,
        frames: gone.into_iter().map(|frame| frame as u64).collect(),
    })
}
