//! Errors of files and queries.

use std::path::PathBuf;

/// Why a query failed, or a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum ColumnarError {
    /// A damaged file.
    #[error("{} is damaged: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The damaged part.
        what: String,
    },
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The query makes more groups than were allowed.
    #[error("more than {0} groups")]
    TooManyGroups(usize),
    /// A column cannot be encoded.
    #[error("cannot encode: {0}")]
    Encoding(#[from] parquet::errors::ParquetError),
}

impl ColumnarError {
    pub(crate) fn damaged(path: &std::path::Path, what: &str) -> Self {
        Self::Damaged {
            path: path.to_owned(),
            what: what.to_owned(),
        }
    }

    pub(crate) fn io(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }

    /// The file at fault.
    #[must_use]
    pub fn file(&self) -> Option<&std::path::Path> {
        match self {
            Self::Damaged { path, .. } | Self::Io { path, .. } => Some(path),
            _ => None,
        }
    }
}
