//! Reads the required parts of a shard's rows from the store.

use std::io::Cursor;

use bytes::Bytes;
use parquet::column::reader::ColumnReader;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};

use crate::error::SetError;
use crate::set::marker::Marker;
use crate::storage::store::Store;

/// Bytes per request if the reader does not know the length that it needs.
const FETCHED_BYTES: u64 = 64 << 10;

/// A file of the store as the Parquet reader sees it.
struct Remote {
    store: Store,
    name: String,
    bytes: u64,
}

impl Length for Remote {
    fn len(&self) -> u64 {
        self.bytes
    }
}

impl ChunkReader for Remote {
    type T = Cursor<Bytes>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        let length = FETCHED_BYTES.min(self.bytes.saturating_sub(start));
        self.get_bytes(start, length as usize).map(Cursor::new)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let range = start..start + length as u64;
        self.store
            .range(&self.name, range)
            .map_err(|error| ParquetError::General(error.to_string()))
    }
}

impl Marker {
    /// Digests of the shard's images in frame order, as its rows have them.
    pub(crate) fn frame_digests(&self, store: &Store) -> Result<Vec<String>, SetError> {
        let name = self.rows_name();
        let remote = Remote {
            store: store.clone(),
            name: name.clone(),
            bytes: self.rows.bytes,
        };
        read_texts(remote, "digest").map_err(|error| SetError::unreadable(&name, error))
    }
}

/// All values of a column of text.
fn read_texts(remote: Remote, column: &str) -> Result<Vec<String>, ParquetError> {
    let reader = SerializedFileReader::new(remote)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let position = schema.columns().iter().position(|found| found.name() == column);
    let position = position.ok_or_else(|| ParquetError::General(format!("column {column} is missing")))?;
    let mut texts = Vec::new();
    for number in 0..reader.num_row_groups() {
        let group = reader.get_row_group(number)?;
        let rows = group.metadata().num_rows() as usize;
        let ColumnReader::ByteArrayColumnReader(mut values) = group.get_column_reader(position)? else {
            return Err(ParquetError::General(format!(
                "{column} is not a column of texts"
            )));
        };
        let (mut levels, mut found): (Vec<i16>, Vec<ByteArray>) = (Vec::new(), Vec::new());
        values.read_records(rows, Some(&mut levels), None, &mut found)?;
        for value in &found {
            texts.push(value.as_utf8()?.to_owned());
        }
    }
    Ok(texts)
}
