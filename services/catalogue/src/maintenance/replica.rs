//! Writing, checking and rebuilding the columnar replica.

use std::collections::BTreeMap;

use columnar::{About, Column, ColumnarError, Named};
use sqlx::sqlite::SqliteConnection;
use sqlx::{AssertSqlSafe, Connection, Row};

use crate::catalogue::Catalogue;
use crate::error::CatalogueError;
use crate::query::columns::measured_name;
use crate::query::filter;
use crate::query::select::Select;
use crate::replica::files as replica_files;
use crate::replica::files::FileRow;
use crate::replica::parts::{gather, kind};

/// Images of a file of the replica. Smaller files would be too many to open per query; larger ones would leave more rows to the
/// tables until they are written.
pub const REPLICA_ROWS: u16 = 32_768;
/// Most rows of a part: texts are stored as 16-bit positions.
const MOST_ROWS: usize = u16::MAX as usize;

/// Rows on their way into a file.
struct Gathered {
    columns: Vec<(String, columnar::Kind, Column)>,
    jobs: BTreeMap<String, u64>,
    /// The result of [`replica_files::count_changes`] when they were read.
    changes: i64,
}

impl Catalogue {
    /// Writes one file of the replica if there are enough images, [`REPLICA_ROWS`] in production. Returns whether it did; call it until it
    /// does not, and again after new images.
    ///
    /// # Errors
    /// [`CatalogueError`], also if the folder of the replica cannot be written.
    pub async fn replicate_some(&self, file_rows: u16) -> Result<bool, CatalogueError> {
        let _alone = self.replica.writing.lock().await;
        self.drop_half_empty().await?;
        let mut reader = self.reader().await?;
        let mut state = reader.begin().await?;
        let files = replica_files::list_files(&mut state).await?;
        self.replica.keep_only(&files).map_err(failed)?;
        let Some(rows) = next_rows(&mut state, &files, i64::from(file_rows.max(1))).await? else {
            return Ok(false);
        };
        let Some(gathered) = self.gather_rows(&mut state, rows).await? else {
            return Ok(false);
        };
        state.rollback().await?;
        drop(reader);
        let about = About {
            first_row: rows.0,
            last_row: rows.1,
            columns: self.columns.replica_digest(),
            jobs: gathered.jobs.clone(),
            checksums: Vec::new(),
        };
        let (folder, columns, copy) = (self.replica.folder.clone(), gathered.columns, about.clone());
        let named = tokio::task::spawn_blocking(move || columnar::write(&folder, &columns, copy));
        let named = named.await.map_err(failed)?.map_err(failed)?;
        faults::point("mirror.written");
        let changes = gathered.changes;
        let taken = self.write(move |c| Box::pin(async move { take(c, &named, &about, changes).await }));
        // A rejected file is removed by the next call.
        taken.await
    }

    /// Writes the whole replica again; returns the number of files.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn rebuild_replica(&self) -> Result<u64, CatalogueError> {
        let all = "DELETE FROM mirror_files";
        self.write(move |c| Box::pin(async move { Ok(sqlx::query(all).execute(c).await.map(drop)?) }))
            .await?;
        let mut files = 0;
        while self.replicate_some(REPLICA_ROWS).await? {
            files += 1;
        }
        Ok(files)
    }

    /// Compares the whole replica with the tables and returns the differences. Faulty files are removed from the list, so that they are
    /// not used, and [`Catalogue::replicate_some`] writes them again.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn check_replica(&self) -> Result<Vec<String>, CatalogueError> {
        let _alone = self.replica.writing.lock().await;
        let files = replica_files::list_files(&mut *self.reader().await?).await?;
        let mut findings = Vec::new();
        for row in files {
            if let Err(error) = self.check_file(&row).await? {
                findings.push(error);
                self.forget_file(&row.name).await?;
            }
        }
        Ok(findings)
    }

    /// Removes a file from the list; returns whether it was listed.
    pub(crate) async fn forget_file(&self, name: &str) -> Result<bool, CatalogueError> {
        let name = name.to_owned();
        self.write(move |c| {
            Box::pin(async move {
                let gone = sqlx::query("DELETE FROM mirror_files WHERE name = ?").bind(name);
                Ok(gone.execute(c).await?.rows_affected() > 0)
            })
        })
        .await
    }

    async fn check_file(&self, row: &FileRow) -> Result<Result<(), String>, CatalogueError> {
        let mut reader = self.reader().await?;
        let listed: Vec<(String, i64)> =
            sqlx::query_as("SELECT job_id, images FROM mirror_jobs WHERE file = ?")
                .bind(&row.name)
                .fetch_all(&mut *reader)
                .await?;
        let gathered = self
            .gather_rows(&mut reader, (row.first_row, row.last_row))
            .await?;
        let file = match self.replica.open(row) {
            Ok(file) => file,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let listed: BTreeMap<String, u64> = listed
            .into_iter()
            .map(|(job, images)| (job, images as u64))
            .collect();
        let differs = |what: &str| Ok(Err(format!("{}: {what} differs from the catalogue", row.name)));
        if listed
            .iter()
            .any(|(job, images)| file.about().jobs.get(job) != Some(images))
        {
            return differs("its list of jobs");
        }
        // Jobs that are being deleted have rows left in one and not in the other.
        let gathered = gathered.filter(|gathered| gathered.jobs == file.about().jobs);
        let checked = tokio::task::spawn_blocking(move || {
            file.check()?;
            for (name, _, column) in gathered.iter().flat_map(|gathered| &gathered.columns) {
                if file.read(name)?.is_other_than(column) {
                    return Ok(Some(name.clone()));
                }
            }
            Ok::<_, ColumnarError>(None)
        });
        match checked.await.map_err(failed)? {
            Ok(None) => Ok(Ok(())),
            Ok(Some(name)) => differs(&name),
            Err(error) => Ok(Err(error.to_string())),
        }
    }

    /// Removes files with less than half of their rows from the list; their rows are written again together with those of neighboring gaps.
    async fn drop_half_empty(&self) -> Result<(), CatalogueError> {
        let sparse: Vec<String> = sqlx::query_scalar(
            "SELECT name FROM mirror_files
             WHERE 2 * (SELECT coalesce(sum(images), 0) FROM mirror_jobs WHERE file = name) < images",
        )
        .fetch_all(&mut *self.reader().await?)
        .await?;
        for name in sparse {
            self.forget_file(&name).await?;
        }
        Ok(())
    }

    /// The images of these rowids with all columns that any of them has. `None`: more pictures were measured than one query joins.
    async fn gather_rows(
        &self,
        state: &mut SqliteConnection,
        rows: (i64, i64),
    ) -> Result<Option<Gathered>, CatalogueError> {
        /// As [`Select`] joins.
        const MOST_SUBJECTS: usize = 32;
        let changes = replica_files::count_changes(state).await?;
        let mut columns = self.used_columns(state, rows).await?;
        let measured = self.used_metrics(state, rows).await?;
        if measured.len() > MOST_SUBJECTS {
            tracing::warn!(
                subjects = measured.len(),
                "too many measured pictures for the replica"
            );
            return Ok(None);
        }
        let measured = measured.into_iter().flat_map(|(_, metrics)| metrics);
        columns.extend(measured.filter_map(|name| self.columns.get(&name)));
        let sql = Select::of_rows(&self.columns, &columns, None, None, rows)?;
        let lot = gather(state, &sql, &columns, MOST_ROWS).await?;
        let lot = lot.into_iter().next().unwrap_or_else(|| {
            columns
                .iter()
                .map(|column: &filter::Column| columnar::ColumnBuilder::new(kind(column.kind)).build())
                .collect()
        });
        let mut jobs = BTreeMap::new();
        if let Some(Column::Texts { codes, texts }) = lot.first() {
            for code in codes {
                *jobs.entry(texts[usize::from(*code)].to_string()).or_insert(0) += 1;
            }
        }
        let named = columns.iter().zip(lot).map(|(column, values)| {
            let name = column.replica_name.clone().unwrap_or_default();
            (name, kind(column.kind), values)
        });
        Ok(Some(Gathered {
            columns: named.collect(),
            jobs,
            changes,
        }))
    }

    /// The columns that have a value in any of these rows; the job is the first.
    async fn used_columns(
        &self,
        state: &mut SqliteConnection,
        (first, last): (i64, i64),
    ) -> Result<Vec<filter::Column>, CatalogueError> {
        let columns = self.columns.replicated();
        let counts: Vec<String> = columns
            .iter()
            .map(|column| format!("count({})", column.sql))
            .collect();
        let sql = format!(
            "SELECT {} FROM images NOT INDEXED WHERE rowid BETWEEN ? AND ?",
            counts.join(", ")
        );
        let row = sqlx::query(AssertSqlSafe(sql)).bind(first).bind(last);
        let row = row.fetch_one(state).await?;
        let mut used = Vec::new();
        for (at, column) in columns.into_iter().enumerate() {
            if at == 0 || row.try_get::<i64, _>(at)? > 0 {
                used.push(column);
            }
        }
        Ok(used)
    }

    /// The metrics that any of these rows has, by picture.
    async fn used_metrics(
        &self,
        state: &mut SqliteConnection,
        (first, last): (i64, i64),
    ) -> Result<Vec<(String, Vec<String>)>, CatalogueError> {
        let metrics = self.columns.metrics();
        let counts: Vec<String> = metrics
            .iter()
            .map(|name| format!(", count(m.\"{name}\")"))
            .collect();
        let sql = format!(
            "SELECT m.subject{} FROM images NOT INDEXED JOIN measurements AS m
                    ON m.job_id = images.job_id AND m.frame = images.frame
             WHERE images.rowid BETWEEN ? AND ? GROUP BY m.subject",
            counts.concat()
        );
        let rows = sqlx::query(AssertSqlSafe(sql)).bind(first).bind(last);
        let mut used = Vec::new();
        for row in rows.fetch_all(state).await? {
            let subject: String = row.try_get(0)?;
            let mut names = Vec::new();
            for (at, metric) in metrics.iter().enumerate() {
                if row.try_get::<i64, _>(at + 1)? > 0 {
                    names.push(measured_name(&subject, metric));
                }
            }
            used.push((subject, names));
        }
        Ok(used)
    }
}

fn failed(error: impl std::fmt::Display) -> CatalogueError {
    CatalogueError::Failed {
        message: error.to_string(),
    }
}

/// The rowids of the next file: a gap between files, or enough rows after the last one.
async fn next_rows(
    state: &mut SqliteConnection,
    files: &[FileRow],
    file_rows: i64,
) -> Result<Option<(i64, i64)>, CatalogueError> {
    const NTH: &str = "SELECT rowid FROM images WHERE rowid BETWEEN ? AND ? ORDER BY rowid LIMIT 1 OFFSET ?";
    for (first, last) in replica_files::uncovered_rows(files) {
        let nth = async |state: &mut SqliteConnection, place: i64| {
            let row = sqlx::query_scalar(NTH).bind(first).bind(last).bind(place);
            row.fetch_optional(state).await
        };
        let full: Option<i64> = nth(state, file_rows - 1).await?;
        if let Some(end) = full {
            return Ok(Some((first, end)));
        }
        let any: Option<i64> = nth(state, 0).await?;
        if any.is_some() && last < i64::MAX {
            return Ok(Some((first, last)));
        }
    }
    Ok(None)
}

/// Adds a file to the list, unless images were deleted or changed since its rows were read.
async fn take(
    connection: &mut SqliteConnection,
    named: &Named,
    about: &About,
    changes: i64,
) -> Result<bool, CatalogueError> {
    if replica_files::count_changes(connection).await? != changes {
        return Ok(true);
    }
    sqlx::query(
        "INSERT INTO mirror_files (name, first_row, last_row, images, digest, bytes, columns) VALUES (?, ?, ?, ?, ?, ?, ?)",
    )
    .bind(&named.name)
    .bind(about.first_row)
    .bind(about.last_row)
    .bind(about.jobs.values().sum::<u64>() as i64)
    .bind(&named.digest)
    .bind(named.bytes as i64)
    .bind(&about.columns)
    .execute(&mut *connection)
    .await?;
    for (job, images) in &about.jobs {
        sqlx::query("INSERT INTO mirror_jobs (job_id, file, images) VALUES (?, ?, ?)")
            .bind(job)
            .bind(&named.name)
            .bind(*images as i64)
            .execute(&mut *connection)
            .await?;
    }
    Ok(true)
}
