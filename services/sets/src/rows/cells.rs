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

/// The type of a cell.
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
    let fields = columns
        .map(|(name, kind): (&str, Kind)| {
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
        })
        .collect::<Result<_, _>>()?;
    Type::group_type_builder("rows").with_fields(fields).build()
}

/// Cells of a column until their group is written; an empty one costs two bytes.
#[derive(Debug)]
pub(crate) struct Gathered {
    /// 1 for a cell that is not empty.
    levels: Vec<i16>,
    values: Values,
    bytes: usize,
}

#[derive(Debug)]
enum Values {
    Numbers(Vec<f64>),
    Wholes(Vec<i64>),
    Texts(Vec<ByteArray>),
    Flags(Vec<bool>),
}

impl Gathered {
    pub(crate) fn new(kind: Kind) -> Self {
        let values = match kind {
            Kind::Number => Values::Numbers(Vec::new()),
            Kind::Whole | Kind::Large => Values::Wholes(Vec::new()),
            Kind::Text | Kind::File => Values::Texts(Vec::new()),
            Kind::Flag => Values::Flags(Vec::new()),
        };
        Self {
            levels: Vec::new(),
            values,
            bytes: 0,
        }
    }

    /// Adds the next cell; one of another kind than the column's is empty.
    pub(crate) fn push(&mut self, cell: Option<Cell>) {
        let before = self.values.len();
        let text = match (&mut self.values, cell) {
            (Values::Numbers(values), Some(Cell::Number(number))) => {
                values.push(number);
                0
            }
            (Values::Wholes(values), Some(Cell::Whole(number))) => {
                values.push(number);
                0
            }
            (Values::Texts(values), Some(Cell::Text(text))) => add(values, text.into_bytes()),
            (Values::Texts(values), Some(Cell::File(bytes))) => add(values, bytes),
            (Values::Flags(values), Some(Cell::Flag(flag))) => {
                values.push(flag);
                0
            }
            _ => 0,
        };
        let is_there = self.values.len() > before;
        self.levels.push(i16::from(is_there));
        self.bytes += size_of::<i16>() + text + if is_there { self.values.width() } else { 0 };
    }

    /// Size in memory.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }

    pub(crate) fn len(&self) -> usize {
        self.levels.len()
    }

    /// Writes the column as the next one of a group.
    pub(crate) fn write<W: Write + Send>(
        self,
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let Some(mut writer) = group.next_column()? else {
            return Err(ParquetError::General("the schema has fewer columns".to_owned()));
        };
        let levels = Some(self.levels.as_slice());
        match &self.values {
            Values::Numbers(values) => writer.typed::<DoubleType>().write_batch(values, levels, None),
            Values::Wholes(values) => writer.typed::<Int64Type>().write_batch(values, levels, None),
            Values::Texts(values) => writer.typed::<ByteArrayType>().write_batch(values, levels, None),
            Values::Flags(values) => writer.typed::<BoolType>().write_batch(values, levels, None),
        }?;
        writer.close()
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Wholes(values) => values.len(),
            Self::Texts(values) => values.len(),
            Self::Flags(values) => values.len(),
        }
    }

    /// Size of a value without the bytes of a text.
    fn width(&self) -> usize {
        match self {
            Self::Numbers(_) => size_of::<f64>(),
            Self::Wholes(_) => size_of::<i64>(),
            Self::Texts(_) => size_of::<ByteArray>(),
            Self::Flags(_) => size_of::<bool>(),
        }
    }
}

/// Adds a text; returns its length.
fn add(values: &mut Vec<ByteArray>, text: Vec<u8>) -> usize {
    let bytes = text.len();
    values.push(ByteArray::from(text));
    bytes
}

impl Cell {
    pub(crate) fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    pub(crate) fn whole(number: u64) -> Self {
        Self::Whole(number as i64)
    }

    /// The cell of a scalar of a record; `None` for a value of another kind.
    pub(crate) fn of_leaf(kind: LeafKind, value: &Value) -> Option<Self> {
        match kind {
            LeafKind::Number => value.as_f64().map(Self::Number),
            LeafKind::Whole => value.as_i64().map(Self::Whole),
            LeafKind::Large => value.as_u64().map(|number| Self::Whole(number as i64)),
            LeafKind::Text => value.as_str().map(|text| Self::Text(text.to_owned())),
            LeafKind::Length => value.as_array().map(|items| Self::Whole(items.len() as i64)),
        }
    }
}
