//! What can be wrong with a file.

use std::path::PathBuf;

/// Why a question was not answered, or a file not written.
#[derive(Debug, thiserror::Error)]
pub enum ColumnarError {
    /// A file is not what was written.
    #[error("{} is damaged: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What of it.
        what: String,
    },
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The question makes more groups than were allowed.
    #[error("more than {0} groups")]
    TooManyGroups(usize),
    /// A value is not finite, so that bins over all values have no width.
    #[error("a value is not finite")]
    NotFinite,
    /// A column cannot be encoded.
    #[error("cannot encode: {0}")]
    Encoding(#[from] parquet::errors::ParquetError),
}

impl ColumnarError {
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
