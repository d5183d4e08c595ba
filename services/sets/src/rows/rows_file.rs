//! The rows of a shard as Parquet: written group by group, read column by column.

use std::sync::Arc;

use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::writer::SerializedFileWriter;

use crate::error::SetError;
use crate::rows::cells::{Gathered, compressed, schema};
use crate::rows::columns::{Column, Common, Row, columns};
use crate::set::opened::Set;
use crate::storage::upload::{FileSum, Upload};

/// Memory of a group's rows beyond which it is written; some thousand rows.
const GROUP_BYTES: usize = 4 << 20;
/// Rows beyond which a group is written.
const GROUP_ROWS: usize = 2000;
/// Version of the columns' meaning, in the file's metadata.
const SCHEMA_VERSION: &str = "1";

/// Rows on their way into the store.
pub(crate) struct Rows {
    writer: SerializedFileWriter<Upload>,
    upload: Upload,
    columns: Vec<Column>,
    common: Common,
    /// Of each column, the cells of the group that is being filled.
    group: Vec<Gathered>,
}

impl Rows {
    pub(crate) fn new(upload: Upload, set: &Set, common: Common) -> Result<Self, SetError> {
        let card = set.card();
        let columns = columns(set.job()?, &card.metrics);
        let fields = columns.iter().map(|column| (column.name.as_str(), column.kind));
        let schema = schema(fields).map_err(|error| upload.failure(error))?;
        let note = |key: &str, value: &str| KeyValue::new(key.to_owned(), value.to_owned());
        let properties = compressed()
            .set_key_value_metadata(Some(vec![
                note("fathom.job", &card.digest),
                note("fathom.schema", SCHEMA_VERSION),
                note("fathom.code_version", &card.code_version),
            ]))
            .build();
        let writer = SerializedFileWriter::new(upload.clone(), Arc::new(schema), Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(|error| upload.failure(error))?,
            upload,
            group: empty(&columns),
            columns,
            common,
        })
    }

    pub(crate) fn add(&mut self, row: &Row<'_>) -> Result<(), SetError> {
        for (column, cells) in self.columns.iter().zip(&mut self.group) {
            cells.push(column.cell(row, &self.common));
        }
        let bytes: usize = self.group.iter().map(Gathered::bytes).sum();
        if bytes >= GROUP_BYTES || self.group[0].len() == GROUP_ROWS {
            self.write_group()?;
        }
        Ok(())
    }

    pub(crate) fn finish(mut self) -> Result<FileSum, SetError> {
        if self.group[0].len() > 0 {
            self.write_group()?;
        }
        let upload = self.upload;
        self.writer.close().map_err(|error| upload.failure(error))?;
        upload.finish()
    }

    pub(crate) fn abandon(self) {
        self.upload.abandon();
    }

    fn write_group(&mut self) -> Result<(), SetError> {
        let mut write = || {
            let mut group = self.writer.next_row_group()?;
            for column in std::mem::replace(&mut self.group, empty(&self.columns)) {
                column.write(&mut group)?;
            }
            group.close().map(drop)
        };
        write().map_err(|error: ParquetError| self.upload.failure(error))
    }
}

fn empty(columns: &[Column]) -> Vec<Gathered> {
    columns.iter().map(|column| Gathered::new(column.kind)).collect()
}
