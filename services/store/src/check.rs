//! Integrity checks and rewriting of packs.

use std::path::Path;

use sqlx::Connection;

use crate::error::StoreError;
use crate::store::Store;

/// File with the id of the data folder that owns the packs.
const FOLDER: &str = "folder.id";

impl Store {
    /// Returns the faults of each pack: damaged pages, entries with missing or truncated bytes.
    ///
    /// # Errors
    /// [`StoreError::Failed`] if the disk cannot be read.
    pub async fn check(&self) -> Result<Vec<(u32, String)>, StoreError> {
        let packs: Vec<u32> = self.index().packs().keys().copied().collect();
        let mut findings = Vec::new();
        for pack in packs {
            match self.check_pack(pack).await {
                Ok(found) => findings.extend(found.into_iter().map(|finding| (pack, finding))),
                Err(StoreError::Damaged { message }) => findings.push((pack, message)),
                Err(error) => return Err(error),
            }
        }
        Ok(findings)
    }

    async fn check_pack(&self, pack: u32) -> Result<Vec<String>, StoreError> {
        let mut connection = self.shared.folder.open_reader(pack).await?;
        let checked: Result<Vec<String>, sqlx::Error> = async {
            let mut findings: Vec<String> = sqlx::query_scalar("PRAGMA integrity_check")
                .fetch_all(&mut connection)
                .await?;
            findings.retain(|finding| finding != "ok");
            let wrong: Vec<String> = sqlx::query_scalar(
                "SELECT 'entry ' || lower(hex(digest)) || ' has missing or truncated bytes' FROM entry
                 WHERE NOT EXISTS (SELECT 1 FROM data WHERE data.id = entry.data AND length(data.bytes) = entry.length)
                 LIMIT 100",
            )
            .fetch_all(&mut connection)
            .await?;
            findings.extend(wrong);
            Ok(findings)
        }
        .await;
        connection.close().await?;
        Ok(checked?)
    }

    /// Moves all intact blobs out of a pack and removes it. Returns false if damaged blobs keep it.
    ///
    /// # Errors
    /// [`StoreError::Full`] and others. Moved blobs stay moved; call again to continue.
    pub async fn rewrite(&self, pack: u32) -> Result<bool, StoreError> {
        let _alone = self.upkeep.lock().await;
        self.index().seal(pack);
        self.move_out(pack).await?;
        self.writer()?.remove(pack).await
    }

    /// Returns the digests of all blobs.
    #[must_use]
    pub fn digests(&self) -> Vec<[u8; 32]> {
        self.index().digests()
    }

    /// Returns the id of the data folder that owns the packs; `None` before the first [`Store::set_folder`].
    ///
    /// # Errors
    /// [`StoreError::Failed`].
    pub fn folder(&self) -> Result<Option<String>, StoreError> {
        match std::fs::read_to_string(self.shared.folder.0.join(FOLDER)) {
            Ok(text) => Ok(Some(text.trim().to_owned())),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Stores the id of the data folder that owns the packs.
    ///
    /// # Errors
    /// [`StoreError::Full`], [`StoreError::Failed`].
    pub fn set_folder(&self, id: &str) -> Result<(), StoreError> {
        write(&self.shared.folder.0, id)
    }

    pub(crate) fn copy_folder(&self, to: &Path) -> Result<(), StoreError> {
        self.folder()?.map_or(Ok(()), |id| write(to, &id))
    }
}

/// Writes the file atomically.
fn write(packs: &Path, id: &str) -> Result<(), StoreError> {
    let (unfinished, path) = (packs.join("folder.new"), packs.join(FOLDER));
    std::fs::write(&unfinished, id)?;
    std::fs::File::open(&unfinished)?.sync_all()?;
    std::fs::rename(&unfinished, &path)?;
    Ok(std::fs::File::open(packs)?.sync_all()?)
}
