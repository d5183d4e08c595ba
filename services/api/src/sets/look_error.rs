//! Why a poll of a set ends early.

use catalogue::CatalogueError;

use crate::sets::intake::IntakeError;

/// Why a poll ends early. Stored data is kept, and the next poll continues from there.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LookError {
    /// The set cannot be shown; polling again is useless.
    #[error("{0}")]
    Refused(String),
    /// The store does not respond; another poll may succeed.
    #[error("{0}")]
    Later(String),
    /// The set is inconsistent; it may be repaired.
    #[error("{0}")]
    Damaged(String),
    /// The set contradicts the catalogue.
    #[error(transparent)]
    Intake(#[from] IntakeError),
    /// Catalogue error.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
}

impl LookError {
    /// Whether the content of the set must change before a poll can succeed.
    pub(crate) fn is_of_content(&self) -> bool {
        matches!(self, Self::Damaged(_) | Self::Intake(IntakeError::Record { .. }))
    }

    /// Whether another poll is useless.
    pub(crate) fn is_final(&self) -> bool {
        match self {
            Self::Refused(_) | Self::Intake(IntakeError::AnotherJob { .. } | IntakeError::Job { .. }) => true,
            Self::Later(_)
            | Self::Damaged(_)
            | Self::Intake(IntakeError::Catalogue(_) | IntakeError::Record { .. })
            | Self::Catalogue(_) => false,
        }
    }
}
