//! The decoding of a column's bytes.

use std::sync::Arc;

use bytes::{Buf, Bytes};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::{ByteArray, ByteArrayType, DataType};
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, Length, SerializedPageReader};

use crate::column::{Column, ColumnBuilder, Kind, NO_TEXT};
use crate::condition::Range;
use parquet::file::metadata::ColumnChunkMetaData;

/// The bytes of a column, as a reader of the whole file sees them.
pub(super) struct Piece {
    pub(super) start: u64,
    pub(super) bytes: Bytes,
}

impl Length for Piece {
    fn len(&self) -> u64 {
        self.start + self.bytes.len() as u64
    }
}

impl Piece {
    fn tail(&self, start: u64) -> Result<Bytes, ParquetError> {
        let offset = start.checked_sub(self.start).map(|offset| offset as usize);
        offset
            .filter(|offset| *offset <= self.bytes.len())
            .map(|offset| self.bytes.slice(offset..))
            .ok_or_else(|| ParquetError::EOF("outside of the column".to_owned()))
    }
}

impl ChunkReader for Piece {
    type T = bytes::buf::Reader<Bytes>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        Ok(self.tail(start)?.reader())
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let mut bytes = self.tail(start)?;
        if bytes.len() < length {
            return Err(ParquetError::EOF("outside of the column".to_owned()));
        }
        bytes.truncate(length);
        Ok(bytes)
    }
}

/// The values of a column, decoded.
pub(super) fn decoded(piece: &Piece, chunk: &Chunk, rows: usize) -> Result<Column, ParquetError> {
    let piece = Arc::new(Piece {
        start: piece.start,
        bytes: piece.bytes.clone(),
    });
    let pages = SerializedPageReader::new(piece, &chunk.meta, rows, None)?;
    match get_column_reader(chunk.meta.column_descr_ptr(), Box::new(pages)) {
        ColumnReader::DoubleColumnReader(reader) => {
            let (levels, values) = all(reader, rows)?;
            if values.len() == levels.len() {
                return Ok(Column::Numbers(values));
            }
            let mut values = values.into_iter();
            Ok(Column::Numbers(
                levels
                    .iter()
                    .map(|level: &i16| {
                        if *level == 1 {
                            values.next().unwrap_or(f64::NAN)
                        } else {
                            f64::NAN
                        }
                    })
                    .collect(),
            ))
        }
        ColumnReader::Int64ColumnReader(reader) => {
            let (levels, values) = all(reader, rows)?;
            Ok(wholes(
                chunk.kind,
                &levels,
                values.into_iter().map(|value: i64| {
                    if chunk.kind == Kind::Large {
                        value ^ i64::MIN
                    } else {
                        value
                    }
                }),
            ))
        }
        ColumnReader::BoolColumnReader(reader) => {
            let (levels, values) = all(reader, rows)?;
            Ok(wholes(chunk.kind, &levels, values.into_iter().map(i64::from)))
        }
        ColumnReader::ByteArrayColumnReader(reader) => texts(reader, rows),
        _ => Err(ParquetError::General("a type that is never written".to_owned())),
    }
}

/// All levels and values.
fn all<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
) -> Result<(Vec<i16>, Vec<T::T>), ParquetError> {
    let (mut levels, mut values) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
    reader.read_records(rows, Some(&mut levels), None, &mut values)?;
    Ok((levels, values))
}

fn wholes(kind: Kind, levels: &[i16], values: impl Iterator<Item = i64>) -> Column {
    let any_missing = levels.contains(&0);
    let mut values = values;
    if !any_missing {
        return Column::Wholes {
            kind,
            values: values.collect(),
            missing: Vec::new(),
        };
    }
    Column::Wholes {
        kind,
        values: levels
            .iter()
            .map(|level: &i16| {
                if *level == 1 {
                    values.next().unwrap_or(0)
                } else {
                    0
                }
            })
            .collect(),
        missing: levels.iter().map(|level| *level == 0).collect(),
    }
}

/// Equal texts of a dictionary share their bytes, so that most are known by their address: to compare them took most of the time.
fn texts(reader: ColumnReaderImpl<ByteArrayType>, rows: usize) -> Result<Column, ParquetError> {
    /// Slots of the table of recent texts.
    const PLACES: usize = 1024;
    let (levels, values): (_, Vec<ByteArray>) = all(reader, rows)?;
    let mut column = ColumnBuilder::new(Kind::Text);
    let mut seen = vec![((0, 0), NO_TEXT); PLACES];
    let mut values = values.iter();
    for level in levels {
        let text = if level == 1 { values.next() } else { None };
        let Some(text) = text else {
            column.text(None);
            continue;
        };
        let bytes = text.data();
        let address = (bytes.as_ptr() as usize, bytes.len());
        let place = &mut seen[(address.0 ^ (address.0 >> 10)) % PLACES];
        if place.0 == address && place.1 != NO_TEXT {
            column.code(place.1);
        } else {
            *place = (address, column.text(Some(text.as_utf8()?)));
        }
    }
    Ok(column.build())
}

/// The position of a column.
#[derive(Debug)]
pub(super) struct Chunk {
    pub(super) kind: Kind,
    pub(super) meta: Box<ColumnChunkMetaData>,
    pub(super) checksum: u32,
    pub(super) range: Option<Range>,
}
