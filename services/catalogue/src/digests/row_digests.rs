//! A digest of every row with data: computed before the writer commits, verified when the row is read.
//!
//! Statements that change a row do not set it. Triggers of the writer's connection remove the digest of a changed row and keep the
//! old row; before the commit every row without a digest gets one. A row that was damaged before keeps its old digest, and stays
//! recognizably damaged.

use sha2::{Digest, Sha256};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Executor, Row, TypeInfo, ValueRef};

use crate::digests::tables::{TABLES, Table};
use crate::error::CatalogueError;
use crate::query::cells::bound;
use crate::query::filter::Bind;

/// Rows of one statement, when all rows of an older catalogue get their digests.
const BATCH: usize = 10_000;

/// Which rows may be without a digest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// None.
    Reader,
    /// Those that its open transaction has changed.
    Writer,
}

/// 64 bits of SHA-256, which no accident meets.
#[derive(Default)]
pub(crate) struct RowDigest(Sha256);

impl RowDigest {
    /// Adds a value under its name. The length keeps neighbors apart.
    pub(crate) fn add(&mut self, name: &str, kind: u8, value: &[u8]) {
        for part in [name.as_bytes(), &[kind], value] {
            self.0.update((part.len() as u64).to_le_bytes());
            self.0.update(part);
        }
    }

    pub(crate) fn add_text(&mut self, name: &str, value: &str) {
        self.add(name, b't', value.as_bytes());
    }

    pub(crate) fn add_whole(&mut self, name: &str, value: i64) {
        self.add(name, b'i', &value.to_le_bytes());
    }

    pub(crate) fn end(self) -> i64 {
        let digest = self.0.finalize();
        i64::from_le_bytes(std::array::from_fn(|at| digest[at]))
    }
}

impl Table {
    fn names(&self) -> impl Iterator<Item = &'static str> {
        self.columns.split(',').map(str::trim)
    }

    /// `id = ?`
    fn key(&self) -> String {
        let equal: Vec<_> = self
            .names()
            .take(self.keys)
            .map(|name| format!("{name} = ?"))
            .collect();
        equal.join(" AND ")
    }

    /// The digest of a row that begins with the columns.
    fn digest(&self, row: &SqliteRow) -> Result<i64, sqlx::Error> {
        let mut digest = RowDigest::default();
        for (at, name) in self.names().enumerate() {
            let raw = row.try_get_raw(at)?;
            if raw.is_null() {
                continue;
            }
            match raw.type_info().name() {
                "INTEGER" => digest.add_whole(name, row.try_get_unchecked(at)?),
                "REAL" => digest.add(
                    name,
                    b'r',
                    &row.try_get_unchecked::<f64, _>(at)?.to_bits().to_le_bytes(),
                ),
                "BLOB" => digest.add(name, b'b', row.try_get_unchecked(at)?),
                // As bytes, since damaged text need not be text.
                _ => digest.add(name, b't', row.try_get_unchecked(at)?),
            }
        }
        Ok(digest.end())
    }

    fn is_good(&self, row: &SqliteRow, side: Side) -> Result<bool, sqlx::Error> {
        let stored: Option<i64> = row.try_get_unchecked(self.names().count())?;
        match stored {
            Some(stored) => Ok(stored == self.digest(row)?),
            None => Ok(side == Side::Writer),
        }
    }

    /// Refuses a row that does not have its digest. It begins with the columns, and the digest follows.
    pub(crate) fn verify(&self, row: &SqliteRow, side: Side) -> Result<(), CatalogueError> {
        if self.is_good(row, side)? {
            return Ok(());
        }
        Err(CatalogueError::damaged(self.named(row)))
    }

    /// Such as `row job_… of jobs`.
    fn named(&self, row: &SqliteRow) -> String {
        let shown = |at| {
            let text = row.try_get_unchecked::<&[u8], _>(at);
            text.map(|text| String::from_utf8_lossy(text).chars().take(80).collect::<String>())
        };
        let key: Vec<_> = (0..self.keys).filter_map(|at| shown(at).ok()).collect();
        format!("row {} of {}", key.join("/"), self.name)
    }

    fn key_of(&self, row: &SqliteRow) -> Result<Vec<Bind>, sqlx::Error> {
        (0..self.keys)
            .map(|at| match row.try_get_raw(at)?.type_info().name() {
                "INTEGER" => row.try_get_unchecked(at).map(Bind::Whole),
                _ => row.try_get_unchecked(at).map(Bind::Text),
            })
            .collect()
    }

    async fn set(
        &self,
        connection: &mut SqliteConnection,
        row: &SqliteRow,
        digest: i64,
    ) -> Result<(), CatalogueError> {
        let sql = format!("UPDATE {} SET row_digest = ? WHERE {}", self.name, self.key());
        let mut statement = sqlx::query(AssertSqlSafe(sql)).bind(digest);
        for key in self.key_of(row)? {
            statement = bound(statement, Some(&key));
        }
        statement.execute(connection).await?;
        Ok(())
    }

    /// Computes the missing digests.
    async fn fill(&self, connection: &mut SqliteConnection) -> Result<(), CatalogueError> {
        let Self { name, columns, .. } = self;
        let changed = format!("DELETE FROM changed_{name} RETURNING {columns}, row_digest");
        for row in sqlx::query(AssertSqlSafe(changed))
            .fetch_all(&mut *connection)
            .await?
        {
            if !self.is_good(&row, Side::Reader)? {
                let damaged: i64 = row.try_get_unchecked(self.names().count())?;
                tracing::error!(
                    row = self.named(&row),
                    "a damaged row of the catalogue was changed and stays damaged"
                );
                self.set(connection, &row, damaged).await?;
            }
        }
        let without = format!(
            "SELECT {columns} FROM {name} INDEXED BY {name}_undigested WHERE row_digest IS NULL LIMIT {BATCH}"
        );
        loop {
            let rows = sqlx::query(AssertSqlSafe(without.as_str()))
                .fetch_all(&mut *connection)
                .await?;
            for row in &rows {
                self.set(connection, row, self.digest(row)?).await?;
            }
            if rows.len() < BATCH {
                return Ok(());
            }
        }
    }

    /// The rows that do not have their digests.
    pub(crate) async fn damaged(
        &self,
        connection: &mut SqliteConnection,
    ) -> Result<Vec<String>, CatalogueError> {
        use futures::TryStreamExt;
        let sql = format!("SELECT {}, row_digest FROM {}", self.columns, self.name);
        let mut rows = sqlx::query(AssertSqlSafe(sql)).fetch(connection);
        let mut damaged = Vec::new();
        while let Some(row) = rows.try_next().await? {
            if !self.is_good(&row, Side::Reader)? {
                damaged.push(self.named(&row));
            }
        }
        Ok(damaged)
    }
}

/// Prepares the connection that writes.
pub(crate) async fn prepare(connection: &mut SqliteConnection) -> Result<(), CatalogueError> {
    for table in TABLES {
        let Table { name, columns, .. } = table;
        let old: Vec<_> = table.names().map(|column| format!("old.{column}")).collect();
        let new: Vec<_> = table
            .names()
            .take(table.keys)
            .map(|key| format!("{key} = new.{key}"))
            .collect();
        let (old, new) = (old.join(", "), new.join(" AND "));
        let sql = format!(
            "CREATE TEMP TABLE changed_{name} AS SELECT {columns}, row_digest FROM {name} WHERE 0;
             CREATE TEMP TRIGGER change_{name} AFTER UPDATE OF {columns} ON {name} WHEN old.row_digest IS NOT NULL BEGIN
                 INSERT INTO changed_{name} SELECT {old}, old.row_digest;
                 UPDATE {name} SET row_digest = NULL WHERE {new};
             END"
        );
        connection.execute(AssertSqlSafe(sql)).await?;
    }
    Ok(())
}

/// Gives every row that the open transaction has changed its digest.
pub(crate) async fn fill(connection: &mut SqliteConnection) -> Result<(), CatalogueError> {
    let without: Vec<_> = TABLES
        .iter()
        .map(|Table { name, .. }| {
            format!("EXISTS (SELECT 1 FROM {name} INDEXED BY {name}_undigested WHERE row_digest IS NULL)")
        })
        .collect();
    let sql = format!("SELECT {}", without.join(", "));
    let row = sqlx::query(AssertSqlSafe(sql))
        .fetch_one(&mut *connection)
        .await?;
    for (at, table) in TABLES.iter().enumerate() {
        if row.try_get_unchecked(at)? {
            table.fill(connection).await?;
        }
    }
    Ok(())
}

/// A description, if it has its digest.
pub(crate) fn intact<'a>(id: &str, spec: &'a str, digest: &str) -> Result<&'a str, CatalogueError> {
    if spec::sha256(spec.as_bytes()) == digest {
        return Ok(spec);
    }
    Err(CatalogueError::damaged(format!("the description of {id}")))
}
