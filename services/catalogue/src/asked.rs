//! Values of columns over all images of a dataset under a filter, as a statement.
//!
//! The values come to this program one by one. To count them into bins in SQL takes two passes where the range is not
//! given, and a pass costs as much as handing over every second row.

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::{Bind, Column, Compiled, FilterError};
use crate::joins::Joins;
use crate::page::condition;

pub(crate) struct Asked {
    columns: Vec<Column>,
    joins: Joins,
    dataset: String,
    filter: Compiled,
}

impl Asked {
    pub(crate) fn of_dataset(
        columns: &Columns,
        dataset: &str,
        filter: Option<&str>,
    ) -> Result<Self, CatalogueError> {
        let filter = condition(columns, filter)?;
        let mut joins = Joins::default();
        joins.add_all(&filter.joins);
        Ok(Self {
            columns: Vec::new(),
            joins,
            dataset: dataset.to_owned(),
            filter,
        })
    }

    /// Asks for a column, after those before.
    pub(crate) fn select(&mut self, column: &Column) {
        self.joins.add(column);
        self.columns.push(column.clone());
    }

    /// The statement and the values of its places.
    pub(crate) fn statement(self) -> Result<(String, Vec<Bind>), FilterError> {
        let selected: Vec<&str> = self.columns.iter().map(|column| column.sql.as_str()).collect();
        let (images, subjects) = self.joins.images()?;
        let sql = format!(
            "SELECT {} FROM {images}
             WHERE images.dataset = ? AND images.job_id NOT IN (SELECT job_id FROM deletions) AND ({})",
            selected.join(", "),
            self.filter.sql
        );
        let mut binds: Vec<Bind> = self
            .columns
            .iter()
            .flat_map(|column| column.binds.clone())
            .collect();
        binds.extend(subjects);
        binds.push(Bind::Text(self.dataset));
        binds.extend(self.filter.binds);
        Ok((sql, binds))
    }
}
