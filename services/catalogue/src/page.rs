//! Pages of images: filter, order, fields, and cursors that begin the next page where the last one ended.

use futures::TryStreamExt;
use serde_json::{Map, Value, json};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{Row, TypeInfo, ValueRef};

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::cursor;
use crate::error::CatalogueError;
use crate::filter::{Bind, Column, FilterError, Kind, OFFSET};
use crate::select::Select;
use crate::types::{ImageQuery, Page};

/// Every column of a dataset with ten enhancements are some hundreds; SQLite returns at most 2000.
const MOST_FIELDS: usize = 1000;
/// A page ends with the row that reaches this size, about that of its JSON: a thousand ordinary rows have 2 MB.
const PAGE_BYTES: usize = 8 << 20;

/// A column by its name, or an error with the nearest one.
pub(crate) fn column(columns: &Columns, name: &str) -> Result<Column, CatalogueError> {
    columns.get(name).ok_or_else(|| {
        let did_you_mean = spec::nearest(name, &columns.names());
        let unknown = FilterError::new(format!("unknown column `{name}`"));
        CatalogueError::Filter(FilterError {
            did_you_mean,
            ..unknown
        })
    })
}

impl Catalogue {
    /// A page of images: as many as are asked for, or fewer if they are large.
    ///
    /// # Errors
    /// [`CatalogueError::Filter`] for filter, order or fields; [`CatalogueError::Cursor`]; [`CatalogueError::Timeout`].
    pub async fn images(&self, query: ImageQuery) -> Result<Page<Value>, CatalogueError> {
        within(images(&mut *self.reader().await?, &self.columns, &query)).await
    }
}

async fn images(
    connection: &mut SqliteConnection,
    columns: &Columns,
    query: &ImageQuery,
) -> Result<Page<Value>, CatalogueError> {
    let question = Question::new(columns, query)?;
    let mut rows = question.sql.statement().fetch(connection);
    let (mut items, mut bytes) = (Vec::new(), 0);
    let mut last = None;
    let mut next_cursor = None;
    while let Some(row) = rows.try_next().await? {
        if items.len() == query.limit as usize || bytes >= PAGE_BYTES {
            let places = last.map(|row| question.order.place(&row, question.names.len()));
            next_cursor = places
                .transpose()?
                .map(|place| cursor::write(&question.identity, &place));
            break;
        }
        let item = item(&row, &question.names)?;
        bytes += size(&item);
        items.push(Value::Object(item));
        last = Some(row);
    }
    Ok(Page { items, next_cursor })
}

/// About the length of an item as JSON.
fn size(item: &Map<String, Value>) -> usize {
    /// Quotes, colon, comma and a number of usual length.
    const BESIDE: usize = 16;
    let pairs = item.iter();
    pairs
        .map(|(name, value)| name.len() + BESIDE + value.as_str().map_or(0, str::len))
        .sum()
}

/// A page as a statement.
struct Question {
    sql: Select,
    /// The fields of an item, with what they hold.
    names: Vec<(String, Kind)>,
    order: Order,
    /// What a cursor belongs to.
    identity: String,
}

impl Question {
    fn new(columns: &Columns, query: &ImageQuery) -> Result<Self, CatalogueError> {
        let names = if query.fields.is_empty() {
            columns.names()
        } else {
            query.fields.clone()
        };
        if names.len() > MOST_FIELDS {
            let message = format!("{} fields; there may be {MOST_FIELDS}", names.len());
            return Err(CatalogueError::refused(message));
        }
        let mut selected = names
            .iter()
            .map(|name| column(columns, name))
            .collect::<Result<Vec<_>, _>>()?;
        let kinds: Vec<Kind> = selected.iter().map(|column| column.kind).collect();
        let order = Order::parse(columns, query.order_by.as_deref())?;
        // The cursor needs the place of the last row, whatever was asked for.
        selected.extend([column(columns, "job")?, column(columns, "frame")?]);
        selected.extend(order.column.clone());

        let (filter, dataset) = (query.filter.as_deref(), query.dataset.as_deref());
        let mut sql = Select::new(columns, &selected, filter, dataset)?;
        let identity = cursor::question(&[dataset, filter, query.order_by.as_deref()]);
        if let Some(text) = &query.cursor {
            order.after(&mut sql, &cursor::read(&identity, text)?)?;
        }
        order.by(&mut sql);
        sql.push(" LIMIT ?");
        sql.bind(Bind::Whole(i64::from(query.limit) + 1));
        Ok(Self {
            sql,
            names: names.into_iter().zip(kinds).collect(),
            order,
            identity,
        })
    }
}

/// The order of a page: a column with missing values last, then job and frame.
struct Order {
    column: Option<Column>,
    descending: bool,
}

impl Order {
    fn parse(columns: &Columns, text: Option<&str>) -> Result<Self, CatalogueError> {
        let Some(text) = text.filter(|text| !text.is_empty()) else {
            return Ok(Self {
                column: None,
                descending: false,
            });
        };
        let (name, descending) = text.strip_prefix('-').map_or((text, false), |name| (name, true));
        Ok(Self {
            column: Some(column(columns, name)?),
            descending,
        })
    }

    fn by(&self, sql: &mut Select) {
        sql.push(" ORDER BY ");
        if let Some(column) = &self.column {
            sql.column(column);
            sql.push(" IS NULL, ");
            sql.column(column);
            sql.push(if self.descending { " DESC, " } else { ", " });
        }
        sql.push("images.job_id, images.frame");
    }

    /// Only what comes after a place.
    fn after(&self, sql: &mut Select, place: &Value) -> Result<(), CatalogueError> {
        let (Some(job), Some(frame)) = (place[1].as_str(), place[2].as_f64()) else {
            return Err(CatalogueError::Cursor);
        };
        let (job, frame) = (Bind::Text(job.to_owned()), Bind::Number(frame));
        const BEHIND: &str = "(images.job_id, images.frame) > (?, ?)";
        sql.push(" AND (");
        let key = match &place[0] {
            Value::Null => None,
            Value::Number(number) => number
                .as_i64()
                .map(Bind::Whole)
                .or(number.as_f64().map(Bind::Number)),
            Value::String(text) => Some(Bind::Text(text.clone())),
            _ => return Err(CatalogueError::Cursor),
        };
        match (&self.column, key) {
            (None, _) => sql.push(BEHIND),
            (Some(column), None) => {
                sql.column(column);
                sql.push(" IS NULL AND ");
                sql.push(BEHIND);
            }
            (Some(column), Some(key)) => {
                sql.column(column);
                sql.push(if self.descending { " < ? OR " } else { " > ? OR " });
                sql.bind(key.clone());
                sql.column(column);
                sql.push(" IS NULL OR (");
                sql.column(column);
                sql.push(" = ? AND ");
                sql.bind(key);
                sql.push(BEHIND);
                sql.push(")");
            }
        }
        sql.bind(job);
        sql.bind(frame);
        sql.push(")");
        Ok(())
    }

    /// Where a row stands: the value of the order column, job, frame.
    fn place(&self, row: &SqliteRow, fields: usize) -> Result<Value, CatalogueError> {
        let key = if self.column.is_some() {
            stored(row, fields + 2)?
        } else {
            Value::Null
        };
        Ok(json!([key, stored(row, fields)?, stored(row, fields + 1)?]))
    }
}

/// A row as an object; what is missing is left out.
fn item(row: &SqliteRow, names: &[(String, Kind)]) -> Result<Map<String, Value>, CatalogueError> {
    let mut item = Map::new();
    for (index, (name, kind)) in names.iter().enumerate() {
        let value = value(row, index, *kind)?;
        if !value.is_null() {
            item.insert(name.clone(), value);
        }
    }
    Ok(item)
}

/// A value as it is meant: SQLite has no booleans and no numbers from 2^63 on, and keeps whole numbers of old catalogues
/// as doubles.
pub(crate) fn value(row: &SqliteRow, index: usize, kind: Kind) -> Result<Value, CatalogueError> {
    let stored = stored(row, index)?;
    Ok(match (kind, stored.as_i64(), stored.as_f64()) {
        (Kind::Bool, _, Some(number)) => json!(number != 0.0),
        (Kind::Large, Some(lowered), _) => json!((i128::from(lowered) + OFFSET) as u64),
        (Kind::Whole, None, Some(number)) => json!(number as i64),
        _ => stored,
    })
}

/// A number as a double, the nearest where it is large.
pub(crate) fn double(row: &SqliteRow, index: usize, kind: Kind) -> Result<Option<f64>, CatalogueError> {
    let number = match kind {
        Kind::Large => {
            let lowered: Option<i64> = row.try_get_unchecked(index)?;
            lowered.map(|lowered| (i128::from(lowered) + OFFSET) as f64)
        }
        _ => row.try_get_unchecked(index)?,
    };
    Ok(number)
}

/// A value as it is stored, of whatever type it has.
fn stored(row: &SqliteRow, index: usize) -> Result<Value, CatalogueError> {
    let raw = row.try_get_raw(index)?;
    if raw.is_null() {
        return Ok(Value::Null);
    }
    match raw.type_info().name() {
        "INTEGER" => Ok(json!(row.try_get_unchecked::<i64, _>(index)?)),
        "REAL" => {
            let number = row.try_get_unchecked::<f64, _>(index)?;
            // Whole ones read better as whole numbers, and were returned so when all numbers were doubles.
            let whole = number.fract() == 0.0 && number.abs() < 9e15;
            Ok(if whole {
                json!(number as i64)
            } else {
                json!(number)
            })
        }
        _ => Ok(json!(row.try_get_unchecked::<String, _>(index)?)),
    }
}

#[cfg(test)]
mod plans;
