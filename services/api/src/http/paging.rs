//! Pages of a list: `items`, and the cursor of the next page while there is one.

use serde::Serialize;
use utoipa::ToSchema;

use crate::http::problem::{Problem, Slug};
use crate::limits;

/// A page of a list.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Page<T> {
    /// The rows.
    pub(crate) items: Vec<T>,
    /// Pass it as `cursor` for the next page; null: this is the last one.
    pub(crate) next_cursor: Option<String>,
}

/// The number of rows to answer.
pub(crate) fn rows(limit: Option<u32>) -> Result<u32, Problem> {
    match limit {
        None => Ok(limits::DEFAULT_PAGE_ROWS),
        Some(rows @ 1..=limits::MAX_PAGE_ROWS) => Ok(rows),
        Some(rows) => {
            let detail = format!("limit: is {rows} but must be in 1..={}", limits::MAX_PAGE_ROWS);
            Err(Problem::new(Slug::InvalidQuery, detail))
        }
    }
}
