//! A file: its footer, read once, and its columns, each compared with its checksum whenever it is read.

use std::collections::{BTreeMap, HashMap};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use parquet::basic::Type as Physical;
use parquet::file::metadata::ParquetMetaDataReader;
use parquet::file::statistics::Statistics;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

mod decode;

use self::decode::{Piece, decoded};
use crate::column::{Column, Kind};
use crate::condition::{Bound, Range};
use crate::error::ColumnarError;
use decode::Chunk;

/// The name of [`About`] among the key-value pairs of the footer.
pub(crate) const ABOUT: &str = "fathom";
/// Length of the footer and the magic number, which end a file.
const TRAILER: usize = 8;

/// The description of a file in its footer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct About {
    /// The place of its first row in the catalogue.
    pub first_row: i64,
    /// That of its last row.
    pub last_row: i64,
    /// Digest of the names of all columns that it may have.
    pub columns: String,
    /// Rows of each job.
    pub jobs: BTreeMap<String, u64>,
    /// CRC-32 of each column, in their order.
    #[serde(default)]
    pub checksums: Vec<u32>,
}

/// How a file is found and known again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Its name in the folder.
    pub name: String,
    /// SHA-256 of its footer, in hexadecimal.
    pub digest: String,
    /// Its length.
    pub bytes: u64,
}

/// An open file.
#[derive(Debug)]
pub struct ReplicaFile {
    path: PathBuf,
    about: About,
    rows: usize,
    chunks: HashMap<String, Chunk>,
    /// Among all files of this process.
    pub(crate) id: u64,
}

/// SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hex::encode(Sha256::digest(bytes))
}

/// The footer with the trailer, of the bytes at the end of a file.
pub(crate) fn footer(end: &[u8]) -> Option<&[u8]> {
    let trailer = end.len().checked_sub(TRAILER)?;
    let length = u32::from_le_bytes(end[trailer..trailer + 4].try_into().ok()?) as usize;
    end.get(trailer.checked_sub(length)?..)
}

/// The bytes of a file of this length from a position on.
fn read_from(file: &std::fs::File, from: u64, length: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = vec![0; (length - from) as usize];
    file.read_exact_at(&mut bytes, from).map(|()| bytes)
}

impl ReplicaFile {
    /// Opens a file with a footer of this digest.
    ///
    /// # Errors
    /// [`ColumnarError::Damaged`], [`ColumnarError::Io`].
    pub fn open(path: &Path, digest: &str) -> Result<Self, ColumnarError> {
        let file = std::fs::File::open(path).map_err(ColumnarError::io(path))?;
        let length = file.metadata().map_err(ColumnarError::io(path))?.len();
        let trailer_at = length
            .checked_sub(TRAILER as u64)
            .ok_or_else(|| ColumnarError::damaged(path, "its length"))?;
        let trailer = read_from(&file, trailer_at, length).map_err(ColumnarError::io(path))?;
        let footer_length = u64::from(u32::from_le_bytes([
            trailer[0], trailer[1], trailer[2], trailer[3],
        ]));
        let footer_at = trailer_at
            .checked_sub(footer_length)
            .ok_or_else(|| ColumnarError::damaged(path, "its footer"))?;
        let footer = read_from(&file, footer_at, length).map_err(ColumnarError::io(path))?;
        if sha256(&footer) != digest {
            return Err(ColumnarError::damaged(path, "its footer"));
        }
        Self::parse(path, &footer[..footer.len() - TRAILER])
            .ok_or_else(|| ColumnarError::damaged(path, "its footer"))
    }

    fn parse(path: &Path, footer: &[u8]) -> Option<Self> {
        static NEXT: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);
        let footer = ParquetMetaDataReader::decode_metadata(footer).ok()?;
        let pairs = footer.file_metadata().key_value_metadata()?;
        let about = pairs.iter().find(|pair| pair.key == ABOUT)?.value.as_ref()?;
        let about: About = serde_json::from_str(about).ok()?;
        let group = footer.row_groups().first()?;
        let rows = group.num_rows() as usize;
        let chunks = group
            .columns()
            .iter()
            .zip(&about.checksums)
            .map(|(meta, checksum)| {
                let kind = match meta.column_type() {
                    Physical::DOUBLE => Kind::Number,
                    Physical::BOOLEAN => Kind::Flag,
                    Physical::BYTE_ARRAY => Kind::Text,
                    _ if meta.column_descr().logical_type_ref().is_some() => Kind::Large,
                    _ => Kind::Whole,
                };
                let range = meta.statistics().and_then(|known| range(known, kind));
                let chunk = Chunk {
                    kind,
                    meta: Box::new(meta.clone()),
                    checksum: *checksum,
                    range,
                };
                (
                    meta.column_path().parts().first().cloned().unwrap_or_default(),
                    chunk,
                )
            });
        Some(Self {
            path: path.to_owned(),
            rows,
            chunks: chunks.collect(),
            id: NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed),
            about,
        })
    }

    /// Its description.
    #[must_use]
    pub fn about(&self) -> &About {
        &self.about
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Reads a column. One that the file does not have is missing in every row.
    ///
    /// # Errors
    /// [`ColumnarError::Damaged`], [`ColumnarError::Io`].
    pub fn read(&self, name: &str) -> Result<Column, ColumnarError> {
        let Some(chunk) = self.chunks.get(name) else {
            return Ok(Column::Missing(self.rows));
        };
        let piece = self.piece(chunk, name)?;
        let column =
            decoded(&piece, chunk, self.rows).map_err(|error| self.damaged(&format!("{name}: {error}")))?;
        if column.len() == self.rows {
            Ok(column)
        } else {
            Err(self.damaged(name))
        }
    }

    pub(crate) fn range(&self, name: &str) -> Option<Range> {
        self.chunks.get(name).and_then(|chunk| chunk.range)
    }

    /// Compares every column with its checksum.
    ///
    /// # Errors
    /// [`ColumnarError::Damaged`], [`ColumnarError::Io`].
    pub fn check(&self) -> Result<(), ColumnarError> {
        self.chunks
            .iter()
            .try_for_each(|(name, chunk)| self.piece(chunk, name).map(drop))
    }

    fn piece(&self, chunk: &Chunk, name: &str) -> Result<Piece, ColumnarError> {
        let (start, length) = chunk.meta.byte_range();
        let mut bytes = vec![0; length as usize];
        let file = std::fs::File::open(&self.path).map_err(ColumnarError::io(&self.path))?;
        match file.read_exact_at(&mut bytes, start) {
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Err(self.damaged(name)),
            Err(error) => Err(ColumnarError::io(&self.path)(error)),
            Ok(()) if crc32fast::hash(&bytes) != chunk.checksum => Err(self.damaged(name)),
            Ok(()) => Ok(Piece {
                start,
                bytes: bytes.into(),
            }),
        }
    }

    fn damaged(&self, what: &str) -> ColumnarError {
        ColumnarError::damaged(&self.path, what)
    }
}

/// The bounds of a column's values; `None` for kinds without statistics, and for bounds of zero, whose sign the footer does not show.
fn range(known: &Statistics, kind: Kind) -> Option<Range> {
    let any_missing = known.null_count_opt() != Some(0);
    let (low, high) = match known {
        Statistics::Double(known) => {
            let (low, high) = (*known.min_opt()?, *known.max_opt()?);
            (low != 0.0 && high != 0.0).then_some((Bound::Number(low), Bound::Number(high)))?
        }
        Statistics::Int64(known) if kind == Kind::Whole => {
            (Bound::Whole(*known.min_opt()?), Bound::Whole(*known.max_opt()?))
        }
        _ => return None,
    };
    Some(Range {
        low,
        high,
        any_missing,
    })
}
