//! Maps errors of other crates to problems, except those of sets.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::http::{HeaderValue, header};
use catalogue::CatalogueError;
use store::StoreError;
use wire::MessageError;

use crate::http::problem::{Problem, Slug};

impl From<CatalogueError> for Problem {
    fn from(error: CatalogueError) -> Self {
        match error {
            CatalogueError::Filter(filter) => {
                let problem = Self::new(Slug::InvalidFilter, filter.to_string());
                let problem = match (filter.position, filter.parameter) {
                    (Some(position), _) => problem.with_member("position", position),
                    (None, Some(parameter)) => problem.with_member("parameter", parameter),
                    (None, None) => problem,
                };
                match filter.did_you_mean {
                    Some(name) => problem.with_member("did_you_mean", name),
                    None => problem,
                }
            }
            CatalogueError::Cursor => Self::new(Slug::InvalidCursor, error.to_string()),
            CatalogueError::NotFound { .. } => Self::not_found(error.to_string()),
            CatalogueError::Full { .. } => storage_full(&error),
            CatalogueError::Unwritable { .. } => storage_failed(&error),
            CatalogueError::Sealed { .. } => Self::new(Slug::Sealed, error.to_string()),
            CatalogueError::InUse { .. } => Self::new(Slug::InUse, error.to_string()),
            CatalogueError::Transition { .. }
            | CatalogueError::Unsealable { .. }
            | CatalogueError::Imported { .. }
            | CatalogueError::Contradicted { .. } => Self::new(Slug::JobState, error.to_string()),
            CatalogueError::Timeout { .. } => Self::new(Slug::QueryTooSlow, error.to_string()),
            CatalogueError::Busy => Self::overloaded(error.to_string()),
            CatalogueError::Locked => {
                log_lock(&error);
                Self::overloaded(error.to_string())
            }
            CatalogueError::Damaged { .. } => {
                tracing::error!(%error, "the catalogue is damaged");
                Self::new(Slug::CorruptArtifact, error.to_string())
            }
            CatalogueError::Closed => Self::overloaded("the service is stopping"),
            CatalogueError::SqliteTooOld { .. }
            | CatalogueError::Open { .. }
            | CatalogueError::Failed { .. } => Self::internal(&error),
        }
    }
}

/// Warns about a locked catalogue, at most once a minute.
fn log_lock(error: &CatalogueError) {
    const INTERVAL: Duration = Duration::from_secs(60);
    static LAST: Mutex<Option<Instant>> = Mutex::new(None);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if last.is_none_or(|last| last.elapsed() >= INTERVAL) {
        *last = Some(Instant::now());
        tracing::warn!(%error, "changes wait");
    }
}

impl From<StoreError> for Problem {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Full { .. } => storage_full(&error),
            StoreError::Unwritable { .. } => storage_failed(&error),
            StoreError::DigestMismatch { .. } | StoreError::NotADigest { .. } => {
                Self::new(Slug::InvalidBody, error.to_string())
            }
            StoreError::Corrupt { .. } => {
                tracing::error!(%error, "a stored artifact is damaged");
                Self::new(Slug::CorruptArtifact, error.to_string())
            }
            StoreError::Closed => Self::overloaded("the service is stopping"),
            StoreError::Damaged { .. } => {
                tracing::error!(%error, "a pack of artifacts is damaged");
                Self::new(Slug::CorruptArtifact, error.to_string())
            }
            StoreError::Pack { .. } | StoreError::Failed { .. } => Self::internal(&error),
        }
    }
}

impl From<MessageError> for Problem {
    fn from(error: MessageError) -> Self {
        Self::new(Slug::InvalidBody, error.to_string())
    }
}

/// Maps an error of the file system during a write.
pub(crate) fn writing(error: &std::io::Error) -> Problem {
    use std::io::ErrorKind;
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => storage_full(error),
        _ => storage_failed(error),
    }
}

pub(crate) fn storage_failed(error: &dyn std::fmt::Display) -> Problem {
    tracing::error!(%error, "the data folder cannot be written");
    let detail = format!("{error}; nothing was stored");
    Problem::new(Slug::StorageFailed, detail).header(header::RETRY_AFTER, HeaderValue::from_static("5"))
}

pub(crate) fn storage_full(error: &dyn std::fmt::Display) -> Problem {
    tracing::error!(%error, "the disk is full");
    Problem::new(
        Slug::StorageFull,
        "the data folder has no space left; reads still work",
    )
}
