//! The order of a page, and the cursors within it.

use serde_json::Value;

use crate::error::CatalogueError;
use crate::query::column_value::column;
use crate::query::columns::Columns;
use crate::query::cursor;
use crate::query::filter::{Bind, Column};
use crate::query::select::Select;
use crate::types::ImageQuery;

/// The identity of a query in its cursors.
pub(super) fn identity(query: &ImageQuery) -> String {
    let parts = [&query.dataset, &query.filter, &query.order_by];
    cursor::query_identity(&parts.map(|part| part.as_deref()))
}

/// The order of a page: a column with missing values last, then job and frame.
pub(super) struct Order {
    pub(super) column: Option<Column>,
    pub(super) descending: bool,
}

impl Order {
    pub(super) fn parse(columns: &Columns, text: Option<&str>) -> Result<Self, CatalogueError> {
        let Some(text) = text.filter(|text| !text.is_empty()) else {
            return Ok(Self {
                column: None,
                descending: false,
            });
        };
        let (name, descending) = text.strip_prefix('-').map_or((text, false), |name| (name, true));
        Ok(Self {
            column: Some(column(columns, name, "order_by")?),
            descending,
        })
    }

    pub(super) fn push_order(&self, sql: &mut Select) {
        sql.push(" ORDER BY ");
        if let Some(column) = &self.column {
            sql.column(column);
            sql.push(" IS NULL, ");
            sql.column(column);
            sql.push(if self.descending { " DESC, " } else { ", " });
        }
        sql.push("images.job_id, images.frame");
    }

    /// Restricts the statement to the rows after a place.
    pub(super) fn push_start(&self, sql: &mut Select, place: &Value) -> Result<(), CatalogueError> {
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
}
