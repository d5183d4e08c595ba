//! The columns and rows of an export's tables.

use client::ColumnInfo;
use serde_json::Value;
use spec::{LabelType, LeafKind, Leaves};

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TableColumn {
    pub(crate) name: String,
    pub(crate) kind: CellKind,
}

/// The type of a column's cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CellKind {
    /// A scalar of a record.
    Leaf(LeafKind),
    Flag,
    /// The bytes of a file.
    File,
}

/// A row: its values by the names of their columns, and the files of the columns of files in their order.
pub(crate) struct TableRow {
    pub(crate) values: Value,
    pub(crate) files: Vec<Vec<u8>>,
}

/// Kind of a label that is of several types.
const MIXED: &str = "mixed";
/// Columns of whole numbers that are not declared in records.
const WHOLE: [&str; 2] = ["frame", "created_ms"];

/// The columns of a dataset as those of a table.
pub(crate) fn table_columns(columns: &[ColumnInfo]) -> Vec<TableColumn> {
    let leaves = Leaves::of_records().scalars;
    let kind = |column: &ColumnInfo| match column.kind.as_str() {
        "bool" => CellKind::Flag,
        MIXED => CellKind::Leaf(LeafKind::Number),
        "number" if WHOLE.contains(&column.name.as_str()) => CellKind::Leaf(LeafKind::Whole),
        "number" => {
            let leaf = leaves.iter().find(|leaf| leaf.name == column.name);
            CellKind::Leaf(leaf.map_or(LeafKind::Number, |leaf| leaf.kind))
        }
        _ => CellKind::Leaf(LeafKind::Text),
    };
    columns
        .iter()
        .flat_map(|column: &ColumnInfo| {
            let own = TableColumn {
                name: column.name.clone(),
                kind: kind(column),
            };
            std::iter::once(own).chain(list_other_types(column))
        })
        .collect()
}

/// The further columns of a label of several types, in addition to that of its numbers.
fn list_other_types(column: &ColumnInfo) -> Vec<TableColumn> {
    if column.kind != MIXED {
        return Vec::new();
    }
    let others = [
        (LabelType::Text, CellKind::Leaf(LeafKind::Text)),
        (LabelType::Bool, CellKind::Flag),
    ];
    let others = others.map(|(label, kind)| TableColumn {
        name: label.mixed_column(&column.name),
        kind,
    });
    others.into()
}

/// The labels of several types.
pub(crate) fn list_mixed(columns: &[ColumnInfo]) -> Vec<String> {
    let mixed = columns.iter().filter(|column| column.kind == MIXED);
    mixed.map(|column| column.name.clone()).collect()
}

/// A column of texts.
pub(crate) fn text_column(name: &str) -> TableColumn {
    TableColumn {
        name: name.to_owned(),
        kind: CellKind::Leaf(LeafKind::Text),
    }
}
