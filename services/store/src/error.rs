use std::path::{Path, PathBuf};

/// SQLite result codes for "no space": FULL, and a failed extension of the WAL's shared-memory file.
const FULL: [i32; 2] = [13, 4874];

/// SQLite primary result codes for damaged pages: CORRUPT, NOTADB, and ERROR, because the store's statements are
/// valid for an intact pack.
const DAMAGED: [i32; 3] = [1, 11, 26];

/// SQLite primary result codes for a disk that refuses writes: READONLY, IOERR, CANTOPEN.
const UNWRITABLE: [i32; 3] = [8, 10, 14];

/// The operating system's code of an input/output error, which has no kind.
const EIO: i32 = 5;

/// An error of the store.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StoreError {
    /// The disk is full. The call stored nothing; reads still work, and writes work again once there is space.
    #[error("no space left for artifacts: {message}")]
    Full {
        /// Message from SQLite or the operating system.
        message: String,
    },
    /// The disk refuses writes. The call stored nothing.
    #[error("the artifact store cannot be written: {message}")]
    Unwritable {
        /// Message from SQLite or the operating system.
        message: String,
    },
    /// The bytes do not have the claimed digest.
    #[error("the artifact was sent with digest {claimed}, but its bytes have digest {found}")]
    DigestMismatch {
        /// The digest sent with the bytes.
        claimed: String,
        /// SHA-256 of the bytes.
        found: String,
    },
    /// Stored bytes no longer have the digest that names them.
    #[error("stored artifact {digest} is damaged")]
    Corrupt {
        /// The expected digest.
        digest: String,
    },
    /// Text in another format than a digest.
    #[error("digest `{text}` is not 64 lower-case hexadecimal digits")]
    NotADigest {
        /// The rejected text.
        text: String,
    },
    /// A file in the folder of packs is foreign or unreadable.
    #[error("{} is not a readable artifact pack: {reason}; move it out of the folder of packs", path.display())]
    Pack {
        /// File path.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
    /// A pack has damaged pages.
    #[error("artifact store: {message}")]
    Damaged {
        /// Message from SQLite.
        message: String,
    },
    /// The store was closed.
    #[error("the artifact store is closed")]
    Closed,
    /// Any other error of SQLite or the file system.
    #[error("artifact store: {message}")]
    Failed {
        /// Message from SQLite or the operating system.
        message: String,
    },
}

impl StoreError {
    pub(crate) fn pack(path: &Path, reason: impl ToString) -> Self {
        Self::Pack {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        let message = error.to_string();
        match code(&error) {
            Some(code) if FULL.contains(&code) => Self::Full { message },
            Some(code) if UNWRITABLE.contains(&(code & 0xff)) => Self::Unwritable { message },
            _ if is_damage(&error) => Self::Damaged { message },
            _ => Self::Failed { message },
        }
    }
}

impl From<std::io::Error> for StoreError {
    fn from(error: std::io::Error) -> Self {
        let message = error.to_string();
        match error.kind() {
            std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded => Self::Full { message },
            std::io::ErrorKind::ReadOnlyFilesystem | std::io::ErrorKind::FileTooLarge => {
                Self::Unwritable { message }
            }
            _ if error.raw_os_error() == Some(EIO) => Self::Unwritable { message },
            _ => Self::Failed { message },
        }
    }
}

/// SQLite result codes for pages that the disk does not return: IOERR_READ, IOERR_SHORT_READ, IOERR_CORRUPTFS.
const UNREADABLE: [i32; 3] = [266, 522, 8458];

/// Whether the disk failed to return pages.
pub(crate) fn is_unreadable(error: &sqlx::Error) -> bool {
    code(error).is_some_and(|code| UNREADABLE.contains(&code))
}

/// Whether SQLite reported damaged pages.
pub(crate) fn is_damage(error: &sqlx::Error) -> bool {
    code(error).is_some_and(|code| DAMAGED.contains(&(code & 0xff)))
}

/// SQLite's extended result code.
fn code(error: &sqlx::Error) -> Option<i32> {
    error.as_database_error()?.code()?.parse().ok()
}
