//! Rows with every column, the record, and one column for the bytes of each kind of file.

use std::fs::File;

use cli::exit::Failure;
use client::ColumnInfo;
use serde_json::{Map, Value};

use crate::commands::dataset::export::format::RECORD;
use crate::commands::dataset::export::formats::exact::{Readers, check_exact};
use crate::commands::dataset::export::formats::table_file::write_table;
use crate::commands::dataset::export::formats::tables::{
    CellKind, TableColumn, TableRow, table_columns, text_column,
};
use crate::commands::dataset::export::input::member::{Member, Pull};

/// Contains only the files, so that readers can open the folder as one table.
pub(crate) const FOLDER: &str = "data";

/// Writes a file of rows.
pub(crate) fn write(
    file: File,
    columns: &[ColumnInfo],
    kinds: &[String],
    pull: &mut Pull<'_>,
) -> Result<(), Failure> {
    let mut all = table_columns(columns);
    all.push(text_column(RECORD));
    let files = kinds
        .iter()
        .filter(|kind| *kind != RECORD)
        .map(|kind| TableColumn {
            name: kind.clone(),
            kind: CellKind::File,
        });
    all.extend(files);
    write_table(file, &all, &mut || {
        pull()?
            .into_iter()
            .map(|member: Member| {
                let mut row = TableRow {
                    values: Value::Object(member.values),
                    files: Vec::new(),
                };
                check_exact(&all, &row.values, Readers::Any)?;
                for (kind, file) in kinds.iter().zip(member.files) {
                    match kind.as_str() {
                        RECORD => row.values[RECORD] = String::from_utf8_lossy(&file.bytes).into(),
                        _ => row.files.push(file.bytes),
                    }
                }
                Ok(row)
            })
            .collect()
    })
}

/// The place of a frame in its line of metadata.
pub(crate) fn place(name: &str) -> Map<String, Value> {
    Map::from_iter([("parquet".to_owned(), format!("{FOLDER}/{name}").into())])
}
