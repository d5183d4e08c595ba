//! Columns by name, and their values in rows.

use serde_json::{Value, json};
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, TypeInfo, ValueRef};

use crate::error::CatalogueError;
use crate::query::columns::Columns;
use crate::query::filter::{Column, FilterError, Kind, raised};
use crate::query::record_value;

/// A column that a parameter names, or an error with the nearest one.
pub(crate) fn column(
    columns: &Columns,
    name: &str,
    parameter: &'static str,
) -> Result<Column, CatalogueError> {
    columns.get(name).ok_or_else(|| {
        let did_you_mean = spec::nearest(name, &columns.names());
        let unknown = FilterError::of_parameter(parameter, &format!("names the unknown column `{name}`"));
        CatalogueError::Filter(FilterError {
            did_you_mean,
            ..unknown
        })
    })
}

/// A value in its declared type: SQLite has no booleans and no numbers from 2^63 on, and keeps whole numbers of old catalogues
/// as doubles.
pub(crate) fn value(row: &SqliteRow, index: usize, kind: Kind) -> Result<Value, CatalogueError> {
    let stored = stored(row, index)?;
    Ok(match (kind, stored.as_i64(), stored.as_f64()) {
        (Kind::Bool, _, Some(number)) => json!(number != 0.0),
        (Kind::Large, Some(lowered), _) => json!(raised(lowered)),
        (Kind::Whole, None, Some(number)) => json!(number as i64),
        _ => stored,
    })
}

/// A number as a double, the nearest where it is large.
pub(crate) fn double(row: &SqliteRow, index: usize, kind: Kind) -> Result<Option<f64>, CatalogueError> {
    let number = match kind {
        Kind::Large => {
            let lowered: Option<i64> = row.try_get_unchecked(index)?;
            lowered.map(|lowered| raised(lowered) as f64)
        }
        _ => row.try_get_unchecked(index)?,
    };
    Ok(number)
}

/// A value in its stored type.
pub(crate) fn stored(row: &SqliteRow, index: usize) -> Result<Value, CatalogueError> {
    let raw = row.try_get_raw(index)?;
    if raw.is_null() {
        return Ok(Value::Null);
    }
    match raw.type_info().name() {
        "INTEGER" => Ok(json!(row.try_get_unchecked::<i64, _>(index)?)),
        "REAL" => Ok(record_value::number(row.try_get_unchecked(index)?)),
        _ => Ok(json!(row.try_get_unchecked::<String, _>(index)?)),
    }
}
