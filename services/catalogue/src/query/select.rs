//! Statements over images: filtered columns with joined rows.
//!
//! Each row is joined once for all of its columns; a lookup per column took most of a page's time.

use std::collections::BTreeSet;

use sqlx::AssertSqlSafe;

use crate::error::CatalogueError;
use crate::query::cells::{Statement, bound};
use crate::query::columns::Columns;
use crate::query::filter::{self, Bind, Column, Compiled, Join};
use crate::query::scope::Scope;

/// SQLite joins 64 tables at most; no image has as many pictures.
const MOST_JOINS: usize = 32;

/// SQL with its binds in the order of their places.
#[derive(Default)]
pub(crate) struct Select {
    pub(crate) text: String,
    binds: Vec<Bind>,
}

impl Select {
    /// Columns of all images, or of those of a dataset or a sealed version of one, under a filter. More conditions may follow.
    pub(crate) fn new(
        columns: &Columns,
        selected: &[Column],
        filter: Option<&str>,
        dataset: Option<&str>,
    ) -> Result<Self, CatalogueError> {
        Self::build(columns, selected, filter, dataset, None)
    }

    /// The same of images of these rowids alone, in their order. No index leads there sooner than they do.
    pub(crate) fn of_rows(
        columns: &Columns,
        selected: &[Column],
        filter: Option<&str>,
        dataset: Option<&str>,
        (first, last): (i64, i64),
    ) -> Result<Self, CatalogueError> {
        Self::build(columns, selected, filter, dataset, Some((first, last)))
    }

    fn build(
        columns: &Columns,
        selected: &[Column],
        filter: Option<&str>,
        dataset: Option<&str>,
        rows: Option<(i64, i64)>,
    ) -> Result<Self, CatalogueError> {
        let filter = Self::filter(columns, filter)?;
        let mut joins: BTreeSet<Join> = selected.iter().filter_map(|column| column.join.clone()).collect();
        joins.extend(filter.iter().flat_map(|filter| filter.joins.clone()));
        let mut sql = Self::default();
        for (index, column) in selected.iter().enumerate() {
            sql.push(if index > 0 { ", " } else { "SELECT " });
            sql.column(column);
        }
        sql.push(if rows.is_some() {
            " FROM images NOT INDEXED"
        } else {
            " FROM images"
        });
        sql.join(&joins)?;
        sql.push(" WHERE images.job_id NOT IN (SELECT job_id FROM deletions)");
        if let Some(filter) = filter {
            sql.push(&format!(" AND ({})", filter.sql));
            sql.binds.extend(filter.binds);
        }
        if let Some(dataset) = dataset {
            sql.restrict(Scope::parse(dataset));
        }
        if let Some((first, last)) = rows {
            sql.push(" AND images.rowid BETWEEN ? AND ? ORDER BY images.rowid");
            sql.bind(Bind::Whole(first));
            sql.bind(Bind::Whole(last));
        }
        Ok(sql)
    }

    /// A filter, unless it is empty.
    pub(crate) fn filter(columns: &Columns, text: Option<&str>) -> Result<Option<Compiled>, CatalogueError> {
        let text = text.filter(|text| !text.trim().is_empty());
        let filter = text.map(|text| filter::compile(text, &|name| columns.get(name), &columns.names()));
        Ok(filter.transpose()?)
    }

    /// Left joins with conditions that SQLite cannot optimize, so that it reads the images in the order of their index under every
    /// filter.
    fn join(&mut self, joins: &BTreeSet<Join>) -> Result<(), CatalogueError> {
        if joins.len() > MOST_JOINS {
            let message = format!("a query may use the measurements of at most {MOST_JOINS} pictures");
            return Err(CatalogueError::refused(message));
        }
        for join in joins {
            let alias = join.alias();
            let table = match join {
                Join::Record => "records",
                Join::Measured(_) => "measurements",
            };
            self.push(&format!(
                " LEFT JOIN {table} AS {alias} ON {alias}.job_id = images.job_id AND {alias}.frame = images.frame"
            ));
            if let Join::Measured(subject) = join {
                self.push(&format!(" AND {alias}.subject = ?"));
                self.bind(Bind::Text(subject.clone()));
            }
        }
        Ok(())
    }

    /// Only images of a dataset, or of a sealed version of it.
    fn restrict(&mut self, scope: Scope<'_>) {
        self.push(" AND images.dataset = ?");
        self.bind(Bind::Text(scope.dataset.to_owned()));
        if let Some(version) = scope.version {
            self.push(
                " AND images.job_id IN (SELECT job_id FROM version_jobs WHERE dataset = ? AND version = ?)",
            );
            self.bind(Bind::Text(scope.dataset.to_owned()));
            self.bind(Bind::Whole(version as i64));
        }
    }

    pub(crate) fn push(&mut self, sql: &str) {
        self.text.push_str(sql);
    }

    pub(crate) fn column(&mut self, column: &Column) {
        self.push(&column.sql);
        self.binds.extend(column.binds.iter().cloned());
    }

    pub(crate) fn bind(&mut self, value: Bind) {
        self.binds.push(value);
    }

    pub(crate) fn statement(&self) -> Statement<'_> {
        self.bound_to(sqlx::query(AssertSqlSafe(self.text.as_str())))
    }

    /// The binds, on a statement with the same places.
    pub(crate) fn bound_to<'q>(&self, statement: Statement<'q>) -> Statement<'q> {
        let binds = self.binds.iter();
        binds.fold(statement, |statement, value| bound(statement, Some(value)))
    }
}
