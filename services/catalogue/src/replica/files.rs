//! The files of the columnar replica, and their list in the catalogue.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use columnar::{Cache, ColumnarError, Part, ReplicaFile};
use sqlx::sqlite::SqliteConnection;

use crate::error::CatalogueError;

/// Columns of files that are kept in memory: with the rest of a service of 10^7 images below 300 MB.
const CACHE_BYTES: usize = 64 << 20;
/// More threads would take the processors from the workers.
const MOST_THREADS: usize = 4;

/// The folder of the replica, and its open files.
pub(crate) struct Replica {
    pub(crate) folder: PathBuf,
    pub(crate) cache: Cache,
    pub(crate) threads: usize,
    open: Mutex<HashMap<String, Arc<ReplicaFile>>>,
    /// Held while files are written or removed.
    pub(crate) writing: tokio::sync::Mutex<()>,
}

/// A file as the catalogue knows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FileRow {
    pub(crate) name: String,
    pub(crate) first_row: i64,
    pub(crate) last_row: i64,
    pub(crate) digest: String,
}

impl Replica {
    /// The replica of the catalogue in this file.
    pub(crate) fn of_catalogue(catalogue: &Path) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            folder: catalogue.with_file_name("mirror"),
            cache: Cache::new(CACHE_BYTES),
            threads: processors.min(MOST_THREADS),
            open: Mutex::default(),
            writing: tokio::sync::Mutex::default(),
        }
    }

    /// A file, which must be as the catalogue knows it.
    pub(crate) fn open(&self, row: &FileRow) -> Result<Arc<ReplicaFile>, ColumnarError> {
        let known = |open: &HashMap<String, Arc<ReplicaFile>>| open.get(&row.name).cloned();
        if let Some(file) = known(&self.open.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(file);
        }
        let path = self.folder.join(&row.name);
        let file = Arc::new(ReplicaFile::open(&path, &row.digest)?);
        let about = file.about();
        if (about.first_row, about.last_row) != (row.first_row, row.last_row) {
            let what = "its place in the catalogue".to_owned();
            return Err(ColumnarError::Damaged { path, what });
        }
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.insert(row.name.clone(), Arc::clone(&file));
        Ok(file)
    }

    /// Closes files that are not listed, and removes other files from the folder.
    pub(crate) fn keep_only(&self, rows: &[FileRow]) -> std::io::Result<()> {
        let named: HashSet<&str> = rows.iter().map(|row| row.name.as_str()).collect();
        self.open
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .retain(|name, _| named.contains(name.as_str()));
        if !self.folder.is_dir() {
            return Ok(());
        }
        for entry in std::fs::read_dir(&self.folder)? {
            let entry = entry?;
            if !named.contains(&*entry.file_name().to_string_lossy()) {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    }

    /// The parts of a query: each file with its requested jobs.
    pub(crate) fn parts(&self, files: Vec<(FileRow, HashSet<String>)>) -> Result<Vec<Part>, ColumnarError> {
        files
            .into_iter()
            .map(|(row, jobs): (FileRow, HashSet<String>)| {
                let file = self.open(&row)?;
                let is_all = jobs.len() == file.about().jobs.len();
                Ok(Part::File {
                    file,
                    jobs: (!is_all).then_some(jobs),
                })
            })
            .collect()
    }
}

/// All files in the order of their rows.
pub(crate) async fn list_files(connection: &mut SqliteConnection) -> Result<Vec<FileRow>, CatalogueError> {
    let rows: Vec<(String, i64, i64, String)> =
        sqlx::query_as("SELECT name, first_row, last_row, digest FROM mirror_files ORDER BY first_row")
            .fetch_all(connection)
            .await?;
    Ok(rows
        .into_iter()
        .map(|(name, first_row, last_row, digest)| FileRow {
            name,
            first_row,
            last_row,
            digest,
        })
        .collect())
}

/// Ranges of rowids that are in no file.
pub(crate) fn uncovered_rows(files: &[FileRow]) -> Vec<(i64, i64)> {
    let (mut gaps, mut next) = (Vec::new(), 1);
    for file in files {
        if next < file.first_row {
            gaps.push((next, file.first_row - 1));
        }
        next = next.max(file.last_row.saturating_add(1));
    }
    gaps.push((next, i64::MAX));
    gaps
}

/// Records that the rows of a hidden job are deleted. Their rowids are reused if they are the last ones.
pub(crate) async fn drop_rows(connection: &mut SqliteConnection, job: &str) -> Result<(), CatalogueError> {
    sqlx::query("DELETE FROM mirror_jobs WHERE job_id = ?")
        .bind(job)
        .execute(&mut *connection)
        .await?;
    sqlx::query("DELETE FROM mirror_files WHERE last_row > (SELECT coalesce(max(rowid), 0) FROM images)")
        .execute(&mut *connection)
        .await?;
    count_change(connection).await
}

/// Records that rows of a visible job are deleted or changed; its files are removed from the list.
pub(crate) async fn drop_changed_rows(
    connection: &mut SqliteConnection,
    job: &str,
) -> Result<(), CatalogueError> {
    sqlx::query("DELETE FROM mirror_files WHERE name IN (SELECT file FROM mirror_jobs WHERE job_id = ?)")
        .bind(job)
        .execute(&mut *connection)
        .await?;
    drop_rows(connection, job).await
}

async fn count_change(connection: &mut SqliteConnection) -> Result<(), CatalogueError> {
    sqlx::query("UPDATE mirror_changes SET changes = changes + 1")
        .execute(connection)
        .await?;
    Ok(())
}

/// Number of deletions and changes of stored images.
pub(crate) async fn count_changes(connection: &mut SqliteConnection) -> Result<i64, CatalogueError> {
    let changes = sqlx::query_scalar("SELECT changes FROM mirror_changes");
    Ok(changes.fetch_one(connection).await?)
}

/// Removes files with other columns from the list.
pub(crate) async fn keep_files_with_columns(
    connection: &mut SqliteConnection,
    digest: &str,
) -> Result<(), CatalogueError> {
    sqlx::query("DELETE FROM mirror_files WHERE columns != ?")
        .bind(digest)
        .execute(connection)
        .await?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_what_no_file_holds() {
        let file = |first_row, last_row| FileRow {
            name: format!("{first_row}"),
            first_row,
            last_row,
            digest: String::new(),
        };
        assert_eq!(uncovered_rows(&[]), [(1, i64::MAX)]);
        let files = [file(1, 10), file(11, 20), file(31, 40), file(50, 60)];
        assert_eq!(uncovered_rows(&files), [(21, 30), (41, 49), (61, i64::MAX)]);
    }
}
