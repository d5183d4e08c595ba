//! The query language, and the columns that queries and pages may name.

pub(crate) mod cache;
pub(crate) mod cells;
pub(crate) mod column_value;
pub(crate) mod columns;
pub(crate) mod cursor;
mod extracted;
pub(crate) mod filter;
pub(crate) mod leaf_tree;
pub(crate) mod list_page;
pub(crate) mod record_reader;
pub(crate) mod record_value;
pub(crate) mod scope;
pub(crate) mod select;
