//! Pages of lists in the order of ids, without damaged rows.

use client::Page;
use serde_json::json;
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

use super::cursor;
use crate::damage::DamageLog;
use crate::error::CatalogueError;

/// The next page would begin behind a damaged row: the rows behind it must not be lost silently.
pub(crate) fn no_next_page(damaged: &[String]) -> CatalogueError {
    CatalogueError::damaged(format!("the place of {}", damaged.join(", ")))
}

/// A page from its rows, which begin with their id, and one more if there is a next page. Damaged rows are left out, named and noted.
pub(crate) fn list_page<T>(
    query: &str,
    rows: &[SqliteRow],
    limit: u32,
    damage: &DamageLog,
    read: impl Fn(&SqliteRow) -> Result<T, CatalogueError>,
) -> Result<Page<T>, CatalogueError> {
    let shown = &rows[..rows.len().min(limit as usize)];
    let (mut items, mut damaged) = (Vec::with_capacity(shown.len()), Vec::new());
    for row in shown {
        items.extend(damage.skip(read(row), &mut damaged)?);
    }
    let has_more = rows.len() > shown.len();
    let last = shown.iter().rev().filter(|_| has_more);
    // A damaged id may be no text.
    let last = last.filter_map(|row| row.try_get::<String, _>(0).ok()).next();
    if has_more && last.is_none() {
        return Err(no_next_page(&damaged));
    }
    Ok(Page {
        items,
        next_cursor: last.map(|id| cursor::write(query, &json!(id))),
        damaged,
    })
}
