//! Digests of stored bytes and the rows that name them.

use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::catalogue::{Catalogue, within};
use crate::error::CatalogueError;
use crate::types::NamedDigest;

impl Catalogue {
    /// For each digest whether a row names it, of an image or of a scene.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn referenced(&self, digests: &[String]) -> Result<Vec<bool>, CatalogueError> {
        let mut reader = self.reader().await?;
        let mut named = Vec::with_capacity(digests.len());
        for digest in digests {
            named.push(is_named(&mut reader, digest).await?);
        }
        Ok(named)
    }

    /// Digests of artifacts in order, those after a digest, each with one of the rows that name it.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn artifacts_after(
        &self,
        after: Option<&str>,
        limit: u32,
    ) -> Result<Vec<NamedDigest>, CatalogueError> {
        within(artifacts_after(
            &mut *self.reader().await?,
            after.unwrap_or(""),
            limit,
        ))
        .await
    }
}

async fn is_named(connection: &mut SqliteConnection, digest: &str) -> Result<bool, CatalogueError> {
    let named = sqlx::query_scalar(
        "SELECT EXISTS (SELECT 1 FROM artifacts
                        WHERE digest = ?1 AND job_id NOT IN (SELECT job_id FROM deletions))
             OR EXISTS (SELECT 1 FROM scenes WHERE rgb_digest = ?1)
             OR EXISTS (SELECT 1 FROM scenes WHERE range_digest = ?1)
             OR EXISTS (SELECT 1 FROM scenes WHERE instances_digest = ?1)",
    );
    Ok(named.bind(digest).fetch_one(connection).await?)
}

async fn artifacts_after(
    connection: &mut SqliteConnection,
    after: &str,
    limit: u32,
) -> Result<Vec<NamedDigest>, CatalogueError> {
    // SQLite takes the other columns from the row that has the minimum.
    let rows = sqlx::query(
        "SELECT digest, min(job_id), frame, kind, bytes FROM artifacts
         WHERE digest > ? AND job_id NOT IN (SELECT job_id FROM deletions)
         GROUP BY digest ORDER BY digest LIMIT ?",
    )
    .bind(after)
    .bind(limit)
    .fetch_all(connection)
    .await?;
    let named = |row: &SqliteRow| -> Result<NamedDigest, sqlx::Error> {
        Ok(NamedDigest {
            digest: row.try_get(0)?,
            job_id: row.try_get(1)?,
            frame: row.try_get::<i64, _>(2)? as u64,
            kind: row.try_get(3)?,
            bytes: row.try_get::<i64, _>(4)? as u64,
        })
    };
    Ok(rows.iter().map(named).collect::<Result<_, _>>()?)
}
