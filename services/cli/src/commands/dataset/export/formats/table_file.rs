//! Writes the tables of an export as Parquet.

use std::fs::File;

use anyhow::Context;
use cli::exit::Failure;
use sets::{Cell, Kind, Table};

use super::tables::{CellKind, TableColumn, TableRow};

/// Writes rows, some at a time, until there are none.
pub(super) fn write_table(
    file: File,
    columns: &[TableColumn],
    pull: &mut dyn FnMut() -> Result<Vec<TableRow>, Failure>,
) -> Result<(), Failure> {
    let named = columns
        .iter()
        .map(|column| (column.name.clone(), kind(column.kind)));
    let named: Vec<(String, Kind)> = named.collect();
    let mut table = Table::create(file, named.clone()).context("cannot begin a table")?;
    loop {
        let rows = pull()?;
        if rows.is_empty() {
            break;
        }
        table
            .write_group(cells(&named, rows))
            .context("cannot write a table")?;
    }
    Ok(table.close().context("cannot complete a table")?)
}

fn kind(kind: CellKind) -> Kind {
    match kind {
        CellKind::Leaf(leaf) => leaf.into(),
        CellKind::Flag => Kind::Flag,
        CellKind::File => Kind::File,
    }
}

/// Rows as columns of cells.
fn cells(columns: &[(String, Kind)], rows: Vec<TableRow>) -> Vec<Vec<Option<Cell>>> {
    let mut cells: Vec<Vec<Option<Cell>>> = vec![Vec::with_capacity(rows.len()); columns.len()];
    for TableRow { values, files } in rows {
        let mut files = files.into_iter();
        for ((name, kind), cells) in columns.iter().zip(&mut cells) {
            cells.push(match kind {
                Kind::File => files.next().map(Cell::File),
                kind => Cell::of_value(*kind, &values[name]),
            });
        }
    }
    cells
}
