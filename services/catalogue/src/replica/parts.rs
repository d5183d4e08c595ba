//! Rows of a statement, by columns.

use columnar::{Column, ColumnBuilder};
use futures::TryStreamExt;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::error::CatalogueError;
use crate::query::column_value::double;
use crate::query::filter;
use crate::query::select::Select;

/// The kind of a column of the replica.
pub(crate) fn kind(kind: filter::Kind) -> columnar::Kind {
    match kind {
        filter::Kind::Number => columnar::Kind::Number,
        filter::Kind::Whole => columnar::Kind::Whole,
        filter::Kind::Large => columnar::Kind::Large,
        filter::Kind::Text | filter::Kind::Label => columnar::Kind::Text,
        filter::Kind::Bool => columnar::Kind::Flag,
    }
}

/// The rows of a statement whose first columns are these, in lots of at most `most`.
pub(crate) async fn gather(
    connection: &mut SqliteConnection,
    sql: &Select,
    columns: &[filter::Column],
    most: usize,
) -> Result<Vec<Vec<Column>>, CatalogueError> {
    let empty = || -> Vec<ColumnBuilder> {
        columns
            .iter()
            .map(|column: &filter::Column| ColumnBuilder::new(kind(column.kind)))
            .collect()
    };
    let mut lots = Vec::new();
    let (mut lot, mut rows_of_lot) = (empty(), 0);
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        for (at, column) in columns.iter().enumerate() {
            add(&mut lot[at], &row, at, column.kind)?;
        }
        rows_of_lot += 1;
        if rows_of_lot == most {
            lots.push(std::mem::replace(&mut lot, empty()));
            rows_of_lot = 0;
        }
    }
    if rows_of_lot > 0 {
        lots.push(lot);
    }
    Ok(lots
        .into_iter()
        .map(|lot: Vec<ColumnBuilder>| lot.into_iter().map(ColumnBuilder::build).collect())
        .collect())
}

fn add(
    column: &mut ColumnBuilder,
    row: &SqliteRow,
    at: usize,
    kind: filter::Kind,
) -> Result<(), CatalogueError> {
    match kind {
        filter::Kind::Number => column.number(double(row, at, kind)?),
        filter::Kind::Text | filter::Kind::Label => {
            column.text(row.try_get_unchecked(at)?);
        }
        filter::Kind::Whole | filter::Kind::Large | filter::Kind::Bool => {
            column.whole(row.try_get_unchecked(at)?);
        }
    }
    Ok(())
}
