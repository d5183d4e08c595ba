//! What can go wrong with stored bytes.

use std::path::{Path, PathBuf};

/// SQLite's result codes that mean "no space": FULL, and the shared-memory file of the WAL that could not grow.
const FULL: [i32; 2] = [13, 4874];

/// SQLite's primary result codes that mean "these pages are not what was written": CORRUPT, NOTADB, and ERROR, since our
/// statements are right for the tables that a pack has.
const DAMAGED: [i32; 3] = [1, 11, 26];

/// An error of the store.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StoreError {
    /// The disk is full. Nothing of the call is stored; reads go on, and so do writes once there is space again.
    #[error("no space left for artifacts: {message}")]
    Full {
        /// What SQLite or the system said.
        message: String,
    },
    /// The bytes do not have the digest they came with.
    #[error("artifact with digest {claimed} has the digest {found}")]
    DigestMismatch {
        /// The digest that came with the bytes.
        claimed: String,
        /// Their SHA-256.
        found: String,
    },
    /// Stored bytes no longer have the digest that names them.
    #[error("stored artifact {digest} is damaged")]
    Corrupt {
        /// The digest they should have.
        digest: String,
    },
    /// Text that is no digest.
    #[error("`{text}` is not 64 lower-case hexadecimal digits")]
    NotADigest {
        /// The text.
        text: String,
    },
    /// A file in the folder of packs is not one of ours, or cannot be read.
    #[error("{} is not a readable artifact pack: {reason}", path.display())]
    Pack {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A pack has pages that are not what was written.
    #[error("artifact store: {message}")]
    Damaged {
        /// What SQLite said.
        message: String,
    },
    /// The store was closed.
    #[error("the artifact store is closed")]
    Closed,
    /// Anything else that a database or a folder reported.
    #[error("artifact store: {message}")]
    Failed {
        /// What it said.
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
            _ => Self::Failed { message },
        }
    }
}

/// Whether SQLite found that pages are damaged.
pub(crate) fn is_damage(error: &sqlx::Error) -> bool {
    code(error).is_some_and(|code| DAMAGED.contains(&(code & 0xff)))
}

/// SQLite's extended result code.
fn code(error: &sqlx::Error) -> Option<i32> {
    error.as_database_error()?.code()?.parse().ok()
}
