//! The rows of a shard as Parquet: written group by group, read column by column.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use crate::columns::{Cell, Column, Common, Kind, Row, columns};
use crate::error::SetError;
use crate::job::Card;
use crate::upload::{FileSum, Upload};

/// Rows of a group. A group is in memory while it grows: some ten megabytes.
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
    group: Vec<Vec<Option<Cell>>>,
}

impl Rows {
    pub(crate) fn new(upload: Upload, card: &Card, common: Common) -> Result<Self, SetError> {
        let columns = columns(card);
        let schema = schema(&columns).map_err(|error| upload.failure(error))?;
        let level = ZstdLevel::default();
        let note = |key: &str, value: &str| KeyValue::new(key.to_owned(), value.to_owned());
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(level))
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
            group: vec![Vec::new(); columns.len()],
            columns,
            common,
        })
    }

    pub(crate) fn add(&mut self, row: &Row<'_>) -> Result<(), SetError> {
        for (column, cells) in self.columns.iter().zip(&mut self.group) {
            cells.push(column.cell(row, &self.common));
        }
        if self.group[0].len() == GROUP_ROWS {
            self.write_group()?;
        }
        Ok(())
    }

    pub(crate) fn finish(mut self) -> Result<FileSum, SetError> {
        if !self.group[0].is_empty() {
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
            for (column, cells) in self.columns.iter().zip(&mut self.group) {
                write_column(&mut group, column.kind, &std::mem::take(cells))?;
            }
            group.close().map(drop)
        };
        write().map_err(|error: ParquetError| self.upload.failure(error))
    }
}

fn schema(columns: &[Column]) -> Result<Type, ParquetError> {
    let field = |column: &Column| {
        let (physical, logical) = match column.kind {
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Whole => (Physical::INT64, None),
            Kind::Large => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Flag => (Physical::BOOLEAN, None),
        };
        let builder = Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical);
        builder.build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("rows").with_fields(fields).build()
}

fn write_column(
    group: &mut SerializedRowGroupWriter<'_, Upload>,
    kind: Kind,
    cells: &[Option<Cell>],
) -> Result<(), ParquetError> {
    let Some(mut writer) = group.next_column()? else {
        return Err(ParquetError::General("the schema has fewer columns".to_owned()));
    };
    let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    let there = cells.iter().flatten();
    match kind {
        Kind::Number => {
            let values: Vec<f64> = there.filter_map(Cell::number).collect();
            writer
                .typed::<DoubleType>()
                .write_batch(&values, Some(&levels), None)?;
        }
        Kind::Whole | Kind::Large => {
            let values: Vec<i64> = there.filter_map(Cell::whole).collect();
            writer
                .typed::<Int64Type>()
                .write_batch(&values, Some(&levels), None)?;
        }
        Kind::Text => {
            let values: Vec<ByteArray> = there.filter_map(Cell::text).map(ByteArray::from).collect();
            writer
                .typed::<ByteArrayType>()
                .write_batch(&values, Some(&levels), None)?;
        }
        Kind::Flag => {
            let values: Vec<bool> = there.filter_map(Cell::flag).collect();
            writer
                .typed::<BoolType>()
                .write_batch(&values, Some(&levels), None)?;
        }
    }
    writer.close()
}

impl Cell {
    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    fn whole(&self) -> Option<i64> {
        match self {
            Self::Whole(number) => Some(*number),
            _ => None,
        }
    }

    fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    fn flag(&self) -> Option<bool> {
        match self {
            Self::Flag(flag) => Some(*flag),
            _ => None,
        }
    }
}
