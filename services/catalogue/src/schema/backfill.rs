//! Wide columns: adds missing ones to the schema, and backfills them from the records of existing images.

use std::collections::BTreeSet;
use std::time::Instant;

use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Connection, Row};

use crate::digests::record_row::About;
use crate::digests::row_digests;
use crate::error::CatalogueError;
use crate::query::cells::bound;
use crate::query::columns::Columns;

/// The marker, among the columns to backfill, of a catalogue whose rows have no digests.
const ROW_DIGEST: &str = "row_digest";
/// Images of one transaction: some megabytes of log, and little to repeat after a kill.
const BATCH: i64 = 2000;

/// Adds missing wide columns, all or none, and records the columns of images that need a backfill. A column with a former name is
/// renamed. The column of a metric that no longer exists is kept.
pub(crate) async fn add_columns(
    connection: &mut SqliteConnection,
    columns: &Columns,
) -> Result<(), CatalogueError> {
    let mut transaction = connection.begin().await?;
    let has_images: bool = sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM images)")
        .fetch_one(&mut *transaction)
        .await?;
    let existing = sqlx::query(
        "SELECT 'images', name FROM pragma_table_info('images')
         UNION ALL SELECT 'measurements', name FROM pragma_table_info('measurements')",
    );
    let existing: BTreeSet<(String, String)> = existing
        .fetch_all(&mut *transaction)
        .await?
        .iter()
        .map(|row| Ok((row.try_get(0)?, row.try_get(1)?)))
        .collect::<Result<_, sqlx::Error>>()?;
    let has = |table: &str, name: &str| existing.contains(&(table.to_owned(), name.to_owned()));
    for column in columns
        .added()
        .iter()
        .filter(|column| !has(column.table, &column.name))
    {
        // Names come from the registries of the program, never from requests.
        let (table, name) = (column.table, column.name.replace('"', ""));
        if let Some(before) = column.before.filter(|before| has(table, before)) {
            let rename = format!("ALTER TABLE {table} RENAME COLUMN \"{before}\" TO \"{name}\"");
            sqlx::query(AssertSqlSafe(rename))
                .execute(&mut *transaction)
                .await?;
            continue;
        }
        let add = format!("ALTER TABLE {table} ADD COLUMN \"{name}\" {}", column.kind);
        sqlx::query(AssertSqlSafe(add)).execute(&mut *transaction).await?;
        if has_images && table == "images" {
            sqlx::query("INSERT OR REPLACE INTO unfilled (column_name, filled_to) VALUES (?, -1)")
                .bind(&name)
                .execute(&mut *transaction)
                .await?;
        }
    }
    Ok(transaction.commit().await?)
}

/// Backfills the recorded columns in batches.
pub(crate) async fn backfill(
    connection: &mut SqliteConnection,
    columns: &Columns,
) -> Result<(), CatalogueError> {
    let unfilled: BTreeSet<String> = sqlx::query_scalar("SELECT column_name FROM unfilled")
        .fetch_all(&mut *connection)
        .await?
        .into_iter()
        .collect();
    if unfilled.is_empty() {
        return Ok(());
    }
    if unfilled.contains(ROW_DIGEST) {
        let mut transaction = connection.begin().await?;
        row_digests::fill(&mut transaction).await?;
        transaction.commit().await?;
    }
    let (began, mut rows) = (Instant::now(), 0);
    tracing::info!(
        columns = unfilled.len(),
        "new columns are filled from the records"
    );
    while let Some(filled) = batch(connection, columns, &unfilled).await? {
        rows += filled;
        tracing::debug!(rows, "filled");
    }
    let seconds = began.elapsed().as_secs_f64();
    tracing::info!(rows, seconds, "new columns are filled");
    Ok(())
}

/// Gives records of an older catalogue their digests.
async fn digest_records(
    connection: &mut SqliteConnection,
    records: &[SqliteRow],
) -> Result<(), CatalogueError> {
    for row in records {
        let (job, frame): (&str, i64) = (row.try_get(2)?, row.try_get(3)?);
        let about = About {
            job,
            frame,
            dataset: row.try_get(4)?,
            created_ms: row.try_get(5)?,
            digest: row.try_get(6)?,
        };
        let digest = about.row_digest(&spec::sha256(row.try_get::<&str, _>(1)?.as_bytes()));
        sqlx::query("UPDATE records SET row_digest = ? WHERE job_id = ? AND frame = ?")
            .bind(digest)
            .bind(job)
            .bind(frame)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

/// Backfills one batch; returns its length, or `None` after the last image.
async fn batch(
    connection: &mut SqliteConnection,
    columns: &Columns,
    unfilled: &BTreeSet<String>,
) -> Result<Option<usize>, CatalogueError> {
    let mut transaction = connection.begin().await?;
    let records = sqlx::query(
        "SELECT images.rowid, record, images.job_id, images.frame, dataset, created_ms, digest
         FROM images JOIN records USING (job_id, frame)
         WHERE images.rowid > (SELECT min(filled_to) FROM unfilled) ORDER BY images.rowid LIMIT ?",
    );
    let records = records.bind(BATCH).fetch_all(&mut *transaction).await?;
    let Some(last) = records.last() else {
        sqlx::query("DELETE FROM unfilled")
            .execute(&mut *transaction)
            .await?;
        transaction.commit().await?;
        return Ok(None);
    };
    let last: i64 = last.try_get(0)?;
    let names: Vec<_> = columns.stored_names().collect();
    let is_new: Vec<bool> = names.iter().map(|name| unfilled.contains(name)).collect();
    let new = names.iter().zip(&is_new).filter(|(_, is_new)| **is_new);
    let set: Vec<_> = new.map(|(name, _)| format!("\"{name}\" = ?")).collect();
    let update = format!("UPDATE images SET {} WHERE rowid = ?", set.join(", "));
    for row in records.iter().filter(|_| !set.is_empty()) {
        let record: &str = row.try_get(1)?;
        let values = columns.stored_values(&mut serde_json::Deserializer::from_str(record))?;
        let mut statement = sqlx::query(AssertSqlSafe(update.as_str()));
        for (value, _) in values.iter().zip(&is_new).filter(|(_, is_new)| **is_new) {
            statement = bound(statement, value.as_ref());
        }
        let statement = statement.bind(row.try_get::<i64, _>(0)?);
        statement.execute(&mut *transaction).await?;
    }
    if unfilled.contains(ROW_DIGEST) {
        digest_records(&mut transaction, &records).await?;
    }
    sqlx::query("UPDATE unfilled SET filled_to = ?")
        .bind(last)
        .execute(&mut *transaction)
        .await?;
    transaction.commit().await?;
    // The log would grow with the catalogue otherwise.
    sqlx::query("PRAGMA wal_checkpoint(PASSIVE)")
        .execute(connection)
        .await?;
    Ok(Some(records.len()))
}
