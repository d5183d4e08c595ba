//! Cells of Parquet columns and how they are written.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use parquet::file::writer::SerializedRowGroupWriter;
use parquet::schema::types::Type;
use serde_json::Value;
use spec::LeafKind;

/// What a cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// Up to 2^64 − 1.
    Large,
    /// A string.
    Text,
    /// Yes or no.
    Flag,
    /// The bytes of a file.
    File,
}

/// A value of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A number.
    Number(f64),
    /// Of a large column, the same 64 bits.
    Whole(i64),
    /// A string.
    Text(String),
    /// Yes or no.
    Flag(bool),
    /// The bytes of a file.
    File(Vec<u8>),
}

impl From<LeafKind> for Kind {
    fn from(kind: LeafKind) -> Self {
        match kind {
            LeafKind::Number => Self::Number,
            LeafKind::Whole | LeafKind::Length => Self::Whole,
            LeafKind::Large => Self::Large,
            LeafKind::Text => Self::Text,
        }
    }
}

/// Compression of all files of rows.
pub(crate) fn compressed() -> WriterPropertiesBuilder {
    WriterProperties::builder().set_compression(Compression::ZSTD(ZstdLevel::default()))
}

/// The schema of columns by their names.
pub(crate) fn schema<'a>(columns: impl Iterator<Item = (&'a str, Kind)>) -> Result<Type, ParquetError> {
    let field = |(name, kind): (&str, Kind)| {
        let (physical, logical) = match kind {
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Whole => (Physical::INT64, None),
            Kind::Large => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Flag => (Physical::BOOLEAN, None),
            Kind::File => (Physical::BYTE_ARRAY, None),
        };
        let builder = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical);
        builder.build().map(Arc::new)
    };
    let fields = columns.map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("rows").with_fields(fields).build()
}

/// Writes the next column of a group.
pub(crate) fn write_column<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
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
        Kind::Text | Kind::File => {
            let values: Vec<ByteArray> = there.filter_map(Cell::bytes).map(ByteArray::from).collect();
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
    /// What a scalar of a record is in a cell; none where it is of another kind.
    pub(crate) fn of_leaf(kind: LeafKind, value: &Value) -> Option<Self> {
        match kind {
            LeafKind::Number => value.as_f64().map(Self::Number),
            LeafKind::Whole => value.as_i64().map(Self::Whole),
            LeafKind::Large => value.as_u64().map(|number| Self::Whole(number as i64)),
            LeafKind::Text => value.as_str().map(|text| Self::Text(text.to_owned())),
            LeafKind::Length => value.as_array().map(|items| Self::Whole(items.len() as i64)),
        }
    }

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

    fn bytes(&self) -> Option<&[u8]> {
        match self {
            Self::Text(text) => Some(text.as_bytes()),
            Self::File(bytes) => Some(bytes),
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
