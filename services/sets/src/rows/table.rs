//! A table in a single file, independent of sets.

use std::fs::File;
use std::io::BufWriter;
use std::sync::Arc;

use parquet::errors::ParquetError;
use parquet::file::writer::SerializedFileWriter;
use serde_json::Value;
use spec::LeafKind;

use crate::rows::cells::{Cell, Gathered, Kind, compressed, schema};

/// A Parquet file that is being written.
pub struct Table {
    writer: SerializedFileWriter<BufWriter<File>>,
    columns: Vec<(String, Kind)>,
}

impl Table {
    /// Begins a file with these columns.
    ///
    /// # Errors
    /// Those of the file, and two columns of one name.
    pub fn create(file: File, columns: Vec<(String, Kind)>) -> Result<Self, ParquetError> {
        let schema = schema(columns.iter().map(|(name, kind)| (name.as_str(), *kind)))?;
        let properties = Arc::new(compressed().build());
        let writer = SerializedFileWriter::new(BufWriter::new(file), Arc::new(schema), properties)?;
        Ok(Self { writer, columns })
    }

    /// Writes a group of rows, column by column.
    ///
    /// # Errors
    /// Those of the file, and columns of different length.
    pub fn write_group(&mut self, cells: Vec<Vec<Option<Cell>>>) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for ((_, kind), cells) in self.columns.iter().zip(cells) {
            let mut column = Gathered::new(*kind);
            cells.into_iter().for_each(|cell| column.push(cell));
            column.write(&mut group)?;
        }
        group.close().map(drop)
    }

    /// Completes the file, durably.
    ///
    /// # Errors
    /// Those of the file.
    pub fn close(self) -> Result<(), ParquetError> {
        let file = self.writer.into_inner()?;
        let file = file.into_inner().map_err(|error| error.into_error())?;
        Ok(file.sync_all()?)
    }
}

impl Cell {
    /// The cell of a value of a row.
    #[must_use]
    pub fn of_value(kind: Kind, value: &Value) -> Option<Self> {
        match kind {
            Kind::Number => Self::of_leaf(LeafKind::Number, value),
            Kind::Whole => Self::of_leaf(LeafKind::Whole, value),
            Kind::Large => Self::of_leaf(LeafKind::Large, value),
            Kind::Text => Self::of_leaf(LeafKind::Text, value),
            Kind::Flag => value.as_bool().map(Self::Flag),
            Kind::File => None,
        }
    }
}
