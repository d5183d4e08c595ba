//! Compaction of sparse packs, and backup of all packs.

use std::path::Path;

use sqlx::Connection;

use crate::error::StoreError;
use crate::pack::Folder;
use crate::store::Store;
use crate::writer::CheckedBlob;

/// Bytes moved in one step. They are held in memory, and other writes wait for the step.
const STEP_BYTES: usize = 32 << 20;

/// Result of a compaction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Compaction {
    /// Removed packs.
    pub packs: u64,
    /// Freed disk space, bytes.
    pub bytes_freed: u64,
}

impl Store {
    /// Rewrites every pack with more than half of its bytes deleted: moves the live blobs to the open pack in steps,
    /// then removes the file. Blobs stay readable throughout, also after a crash. The emptiest pack goes first, so
    /// that a full disk gains space early.
    ///
    /// # Errors
    /// [`StoreError::Full`] and others. Completed steps stay; call again to continue.
    pub async fn compact(&self) -> Result<Compaction, StoreError> {
        let _alone = self.upkeep.lock().await;
        let mut packs: Vec<_> = self
            .index()
            .packs()
            .iter()
            .map(|(&pack, &used)| (used.bytes, pack))
            .collect();
        packs.sort_unstable();
        let mut all = Compaction::default();
        for (live, pack) in packs {
            let size = self.shared.folder.size(pack)?;
            if size <= 2 * live || !self.is_mostly_dead(pack, live).await? {
                continue;
            }
            self.index().seal(pack);
            let moved = self.move_out(pack).await?;
            if self.writer()?.remove(pack).await? {
                all.packs += 1;
                all.bytes_freed += size.saturating_sub(moved);
            }
        }
        Ok(all)
    }

    /// Pages are never quite full, so the file size is not enough.
    async fn is_mostly_dead(&self, pack: u32, live: u64) -> Result<bool, StoreError> {
        let mut connection = self.shared.folder.open_reader(pack).await?;
        let written = sqlx::query_scalar::<_, i64>("SELECT coalesce(sum(length(bytes)), 0) FROM data")
            .fetch_one(&mut connection)
            .await;
        connection.close().await?;
        match written.map_err(StoreError::from) {
            Ok(written) => Ok(u64::try_from(written).unwrap_or(0).saturating_sub(live) > live),
            // Damaged bytes cannot be counted. Without live blobs the pack can be removed.
            Err(StoreError::Damaged { .. }) => Ok(live == 0),
            Err(error) => Err(error),
        }
    }

    /// Moves the blobs of a pack to the open pack; returns the moved bytes. Damaged blobs stay, and with them the
    /// pack.
    pub(crate) async fn move_out(&self, pack: u32) -> Result<u64, StoreError> {
        let (mut step, mut in_step, mut moved) = (Vec::new(), 0, 0);
        let blobs = self.index().digests_in(pack);
        for digest in blobs {
            match self.read(digest).await {
                Ok(None) | Err(StoreError::Corrupt { .. }) => continue,
                Ok(Some(bytes)) => {
                    in_step += bytes.len();
                    step.push(CheckedBlob { digest, bytes });
                }
                Err(error) => return Err(error),
            }
            if in_step >= STEP_BYTES {
                moved += self.move_blobs(pack, std::mem::take(&mut step)).await?;
                in_step = 0;
            }
        }
        Ok(moved + self.move_blobs(pack, step).await?)
    }

    async fn move_blobs(&self, from: u32, step: Vec<CheckedBlob>) -> Result<u64, StoreError> {
        let bytes = step.iter().map(|put| put.bytes.len() as u64).sum();
        self.writer()?.move_blobs(from, step).await?;
        Ok(bytes)
    }

    /// Copies every pack to a folder that another store can open, while this store stays in use. Blobs deleted during
    /// the copy may be missing from it: copy the catalogue first and delete nothing until both copies are complete.
    ///
    /// # Errors
    /// [`StoreError::Failed`], also if the folder already has packs; [`StoreError::Full`].
    pub async fn backup(&self, to: &Path) -> Result<(), StoreError> {
        let _alone = self.upkeep.lock().await;
        let copies = Folder(to.join("packs"));
        std::fs::create_dir_all(&copies.0)?;
        if !copies.packs()?.is_empty() {
            let message = format!("{} has packs already", copies.0.display());
            return Err(StoreError::Failed { message });
        }
        let packs: Vec<u32> = self.index().packs().keys().copied().collect();
        for pack in packs {
            self.copy(pack, &copies).await?;
        }
        self.copy_folder(&copies.0)?;
        copies.sync()
    }

    async fn copy(&self, pack: u32, copies: &Folder) -> Result<(), StoreError> {
        let mut connection = self.shared.folder.open_plain(pack).await?;
        let copied = sqlx::query("VACUUM INTO ?")
            .bind(copies.path(pack).display().to_string())
            .execute(&mut connection)
            .await;
        connection.close().await?;
        match copied.map_err(StoreError::from) {
            Ok(_) => {}
            Err(StoreError::Damaged { message }) => {
                tracing::warn!(pack, message, "a damaged pack is copied as it is");
                std::fs::copy(self.shared.folder.path(pack), copies.path(pack))?;
            }
            Err(error) => return Err(error),
        }
        Ok(std::fs::File::open(copies.path(pack))?.sync_all()?)
    }
}
