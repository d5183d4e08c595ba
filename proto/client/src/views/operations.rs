//! The operation of a service.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A copy of everything that the service has stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = Backup)]
pub struct BackupView {
    /// Its folder on the service's machine. A service started on it goes on from the moment of the copy.
    #[schema(example = "data/backups/bak_0198c0ffee007000800000000000000a")]
    pub folder: String,
    /// Bytes of all its files.
    pub bytes: u64,
}
