//! The rows beside that of an image, joined once for all columns that stand in them: with a lookup for each column, the
//! lookups were most of a page's time.

use std::collections::BTreeSet;

use crate::filter::{Bind, Column, FilterError, Join};

/// SQLite joins 64 tables at most; no image has as many pictures.
const MOST_JOINS: usize = 32;

/// The joins that the columns of a question need.
#[derive(Default)]
pub(crate) struct Joins(BTreeSet<Join>);

impl Joins {
    pub(crate) fn add(&mut self, column: &Column) {
        self.0.extend(column.join.clone());
    }

    pub(crate) fn add_all(&mut self, joins: &BTreeSet<Join>) {
        self.0.extend(joins.iter().cloned());
    }

    /// `images` with its joins, as it stands after FROM. Left joins with conditions that SQLite cannot see through: it
    /// goes through the images in the order of their index, whatever the filter.
    pub(crate) fn images(&self) -> Result<(String, Vec<Bind>), FilterError> {
        if self.0.len() > MOST_JOINS {
            return Err(FilterError {
                position: 0,
                message: format!("a question may be about the measurements of {MOST_JOINS} pictures at most"),
                did_you_mean: None,
            });
        }
        let (mut sql, mut binds) = ("images".to_owned(), Vec::new());
        for join in &self.0 {
            let (alias, table) = (
                join.alias(),
                match join {
                    Join::Record => "records",
                    Join::Measured(_) => "measurements",
                },
            );
            sql.push_str(&format!(
                " LEFT JOIN {table} AS {alias} ON {alias}.job_id = images.job_id AND {alias}.frame = images.frame"
            ));
            if let Join::Measured(subject) = join {
                sql.push_str(&format!(" AND {alias}.subject = ?"));
                binds.push(Bind::Text(subject.clone()));
            }
        }
        Ok((sql, binds))
    }
}
