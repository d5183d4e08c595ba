//! Stored bytes: their space on the disk, the digests about to be named, and how space is reclaimed.

pub(crate) mod naming;
pub(crate) mod reclaim;
pub(crate) mod routes;
pub(crate) mod space;

use std::path::Path;
use std::sync::Arc;

use catalogue::Catalogue;
use store::Store;
use tokio::sync::{Mutex, Notify};

use naming::Naming;
use space::Space;

/// The artifact store and what guards it.
pub(crate) struct Bytes {
    pub(crate) store: Store,
    pub(crate) naming: Naming,
    pub(crate) space: Arc<Space>,
    /// Held while rows and bytes of deleted jobs are removed, and during a backup.
    pub(crate) upkeep: Mutex<()>,
    /// Notified after each deletion.
    pub(crate) reclaim: Notify,
    catalogue: Arc<Catalogue>,
}

impl Bytes {
    pub(crate) fn new(store: Store, catalogue: Arc<Catalogue>, folder: &Path, reserve_bytes: u64) -> Self {
        Self {
            store,
            naming: Naming::default(),
            space: Arc::new(Space::new(folder, reserve_bytes)),
            upkeep: Mutex::default(),
            reclaim: Notify::new(),
            catalogue,
        }
    }
}
