//! Operation of the service: health, metrics, backups.

pub(crate) mod replica;
pub(crate) mod routes;

use std::path::PathBuf;
use std::sync::Arc;

use catalogue::Catalogue;
use tokio_util::sync::CancellationToken;

use crate::bytes::Bytes;
use crate::leases::Leases;
use crate::processes::Processes;
use crate::styles::Styles;

/// State of the operator's endpoints.
pub(crate) struct Operations {
    /// The data folder.
    pub(crate) data: PathBuf,
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) leases: Arc<Leases>,
    pub(crate) styles: Arc<Styles>,
    pub(crate) processes: Arc<Processes>,
    pub(crate) stop: CancellationToken,
}
