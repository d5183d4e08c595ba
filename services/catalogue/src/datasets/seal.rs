//! Sealing and unsealing. The root is computed outside of the writer; the version is stored only if no job has changed meanwhile.

use client::{JobState, UnixMs};
use std::collections::BTreeSet;

use futures::TryStreamExt;
use spec::MerkleTree;
use sqlx::sqlite::SqliteConnection;

use client::VersionRow;

use super::versions::get;
use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::error::CatalogueError;

/// A job of a dataset that is to be sealed.
#[derive(PartialEq, Eq)]
struct Part {
    id: String,
    spec_digest: String,
    bytes: i64,
    /// Grows with every change of the job.
    version: i64,
}

/// A version on its way in.
struct NewVersion {
    dataset: String,
    /// All jobs of the dataset.
    parts: Vec<Part>,
    /// Those with images, each with its root.
    roots: Vec<(String, String)>,
    root: String,
    images: i64,
    code_versions: BTreeSet<String>,
    created_at: UnixMs,
}

impl Catalogue {
    /// Seals the current images of a dataset as its next version. Returns the version, and whether it is new: a dataset that has not
    /// changed since the last seal keeps its version.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::Transition`] naming a job that has not ended; [`CatalogueError::Unsealable`] for a
    /// dataset without images, and for one that changed meanwhile.
    pub async fn seal(&self, dataset: &str, now: UnixMs) -> Result<(VersionRow, bool), CatalogueError> {
        let mut reader = self.reader().await?;
        let parts = ended(&mut reader, dataset).await?;
        let (mut images, mut code_versions, mut roots) = (0, BTreeSet::new(), Vec::new());
        for part in &parts {
            let mut tree = MerkleTree::default();
            let before = images;
            let mut rows = sqlx::query_as::<_, (String, Option<String>)>(
                "SELECT digest, code_version FROM images WHERE job_id = ? ORDER BY frame",
            )
            .bind(&part.id)
            .fetch(&mut *reader);
            while let Some((digest, code_version)) = rows.try_next().await? {
                tree.push(digest);
                code_versions.extend(code_version);
                images += 1;
            }
            if images > before {
                roots.push((&part.spec_digest, tree.root(), &part.id));
            }
        }
        drop(reader);
        roots.sort_unstable();
        let mut tree = MerkleTree::default();
        roots.iter().for_each(|(_, root, _)| tree.push(root));
        let roots = roots
            .into_iter()
            .map(|(_, root, id)| (id.clone(), root))
            .collect();
        let new = NewVersion {
            dataset: dataset.to_owned(),
            roots,
            parts,
            root: tree.root(),
            images,
            code_versions,
            created_at: now,
        };
        self.write(move |c| Box::pin(async move { store(c, &new).await }))
            .await
    }

    /// Unseals a version: its images may change and go again. Its number is not used again.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`].
    pub async fn unseal(&self, dataset: &str, version: u64, now: UnixMs) -> Result<(), CatalogueError> {
        let dataset = dataset.to_owned();
        self.write(move |c| Box::pin(async move { unseal(c, &dataset, version, now).await }))
            .await
    }
}

/// The jobs of a dataset, which all must have ended.
async fn ended(connection: &mut SqliteConnection, dataset: &str) -> Result<Vec<Part>, CatalogueError> {
    let jobs: Vec<(String, String, i64, i64, String)> = sqlx::query_as(
        "SELECT id, spec_digest, bytes, version, state FROM jobs
         WHERE dataset = ? AND id NOT IN (SELECT job_id FROM deletions) ORDER BY id",
    )
    .bind(dataset)
    .fetch_all(connection)
    .await?;
    if jobs.is_empty() {
        return Err(CatalogueError::not_found("dataset", dataset));
    }
    jobs.into_iter()
        .map(
            |(id, spec_digest, bytes, version, state): (String, String, i64, i64, String)| {
                let has_ended = state.parse().is_ok_and(JobState::has_ended);
                if has_ended {
                    return Ok(Part {
                        id,
                        spec_digest,
                        bytes,
                        version,
                    });
                }
                Err(CatalogueError::Transition {
                    id,
                    from: state,
                    to: "sealed with its dataset: wait for it or cancel it".to_owned(),
                })
            },
        )
        .collect()
}

async fn store(
    connection: &mut SqliteConnection,
    new: &NewVersion,
) -> Result<(VersionRow, bool), CatalogueError> {
    let dataset = &new.dataset;
    let unsealable = |reason: &str| CatalogueError::Unsealable {
        dataset: dataset.clone(),
        reason: reason.to_owned(),
    };
    if new.images == 0 {
        return Err(unsealable("has no image"));
    }
    if ended(connection, dataset).await? != new.parts {
        return Err(unsealable("has changed meanwhile: seal it again"));
    }
    let last: Option<(i64, String, bool)> = sqlx::query_as(
        "SELECT version, root, unsealed_ms IS NULL FROM versions WHERE dataset = ? ORDER BY version DESC LIMIT 1",
    )
    .bind(dataset)
    .fetch_optional(&mut *connection)
    .await?;
    let number = match last {
        Some((version, root, true)) if root == new.root => {
            return found(connection, dataset, version, false).await;
        }
        last => last.map_or(1, |(version, ..)| version + 1),
    };
    sqlx::query(
        "INSERT INTO versions (dataset, version, root, images, bytes, code_versions, created_ms) VALUES (?, ?, ?, ?, ?, ?, ?)",
    )
    .bind(dataset)
    .bind(number)
    .bind(&new.root)
    .bind(new.images)
    .bind(new.parts.iter().map(|part| part.bytes).sum::<i64>())
    .bind(serde_json::to_string(&new.code_versions)?)
    .bind(new.created_at.0 as i64)
    .execute(&mut *connection)
    .await?;
    for (job, root) in &new.roots {
        sqlx::query("INSERT INTO version_jobs (dataset, version, job_id, root) VALUES (?, ?, ?, ?)")
            .bind(dataset)
            .bind(number)
            .bind(job)
            .bind(root)
            .execute(&mut *connection)
            .await?;
    }
    found(connection, dataset, number, true).await
}

async fn found(
    connection: &mut SqliteConnection,
    dataset: &str,
    version: i64,
    is_new: bool,
) -> Result<(VersionRow, bool), CatalogueError> {
    let row = get(connection, dataset, version as u64, Side::Writer).await?;
    let row = row.ok_or_else(|| CatalogueError::not_found("version", &format!("{dataset}@{version}")))?;
    Ok((row, is_new))
}

async fn unseal(
    connection: &mut SqliteConnection,
    dataset: &str,
    version: u64,
    now: UnixMs,
) -> Result<(), CatalogueError> {
    let changed = sqlx::query(
        "UPDATE versions SET unsealed_ms = ? WHERE dataset = ? AND version = ? AND unsealed_ms IS NULL",
    )
    .bind(now.0 as i64)
    .bind(dataset)
    .bind(version as i64)
    .execute(&mut *connection)
    .await?;
    if changed.rows_affected() == 0 {
        return Err(CatalogueError::not_found(
            "version",
            &format!("{dataset}@{version}"),
        ));
    }
    sqlx::query("DELETE FROM version_jobs WHERE dataset = ? AND version = ?")
        .bind(dataset)
        .bind(version as i64)
        .execute(connection)
        .await?;
    Ok(())
}
