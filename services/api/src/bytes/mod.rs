//! Stored bytes: disk space, digests awaiting their row, and reclaiming.

pub(crate) mod failure;
pub(crate) mod naming;
pub(crate) mod note;
pub(crate) mod reclaim;
pub(crate) mod routes;
pub(crate) mod sets;
pub(crate) mod space;
pub(crate) mod unnamed;

use std::path::Path;
use std::sync::Arc;

use catalogue::Catalogue;
use store::Store;
use tokio::sync::{Mutex, Notify};

use failure::WriteFailure;
use naming::Naming;
use sets::SetFiles;
use space::Space;

/// The artifact store and its guards.
pub(crate) struct Bytes {
    pub(crate) store: Store,
    /// Bytes of imported images.
    pub(crate) sets: SetFiles,
    pub(crate) naming: Naming,
    pub(crate) space: Arc<Space>,
    pub(crate) failure: WriteFailure,
    /// Held while rows and bytes of deleted jobs are removed, and during a backup.
    pub(crate) upkeep: Mutex<()>,
    /// Notified after each deletion.
    pub(crate) reclaim: Notify,
    pub(crate) catalogue: Arc<Catalogue>,
}

impl Bytes {
    pub(crate) fn new(
        store: Store,
        sets: SetFiles,
        catalogue: Arc<Catalogue>,
        folder: &Path,
        reserve_bytes: u64,
    ) -> Self {
        Self {
            store,
            sets,
            naming: Naming::default(),
            space: Arc::new(Space::new(folder, reserve_bytes)),
            failure: WriteFailure::default(),
            upkeep: Mutex::default(),
            reclaim: Notify::new(),
            catalogue,
        }
    }

    /// The reason why writes fail. After a failure it writes to the folder, the catalogue and the packs each time, so
    /// that it returns `None` as soon as all of them work.
    pub(crate) async fn write_failure(&self) -> Option<String> {
        self.failure.reason()?;
        let reason = self.check_writes().await.err();
        self.failure.set(reason.clone());
        reason
    }

    async fn check_writes(&self) -> Result<(), String> {
        let space = Arc::clone(&self.space);
        let probed = tokio::task::spawn_blocking(move || space.probe()).await;
        probed
            .map_err(|error| error.to_string())?
            .map_err(|error| format!("the data folder cannot be written: {error}"))?;
        self.catalogue
            .check_writes()
            .await
            .map_err(|error| error.to_string())?;
        self.store.check_writes().await.map_err(|error| error.to_string())
    }
}
