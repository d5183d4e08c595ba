//! What is wrong with a pack apart from the bytes of its blobs, and rewriting such a pack.

use std::path::Path;

use sqlx::Connection;

use crate::error::StoreError;
use crate::store::Store;

/// In the folder of packs: the id of the data folder that they belong to.
const FOLDER: &str = "folder.id";

impl Store {
    /// Findings about packs, each with its pack: pages that are not whole, entries without bytes or with another length.
    ///
    /// # Errors
    /// [`StoreError::Failed`] when the disk cannot be read.
    pub async fn check(&self) -> Result<Vec<(u32, String)>, StoreError> {
        let packs: Vec<u32> = self.index().packs().keys().copied().collect();
        let mut findings = Vec::new();
        for pack in packs {
            match self.check_one(pack).await {
                Ok(found) => findings.extend(found.into_iter().map(|finding| (pack, finding))),
                Err(StoreError::Damaged { message }) => findings.push((pack, message)),
                Err(error) => return Err(error),
            }
        }
        Ok(findings)
    }

    async fn check_one(&self, pack: u32) -> Result<Vec<String>, StoreError> {
        let mut connection = self.shared.folder.reader(pack).await?;
        let checked: Result<Vec<String>, sqlx::Error> = async {
            let mut findings: Vec<String> = sqlx::query_scalar("PRAGMA integrity_check")
                .fetch_all(&mut connection)
                .await?;
            findings.retain(|finding| finding != "ok");
            let wrong: Vec<String> = sqlx::query_scalar(
                "SELECT 'entry ' || lower(hex(digest)) || ' has no bytes of its length' FROM entry
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

    /// Moves everything that is good out of a pack and removes it. Returns false if damaged blobs keep it.
    ///
    /// # Errors
    /// [`StoreError::Full`] and others: what is moved stays moved, and another call goes on.
    pub async fn rewrite(&self, pack: u32) -> Result<bool, StoreError> {
        let _alone = self.upkeep.lock().await;
        self.index().seal(pack);
        self.empty(pack).await?;
        self.writer()?.remove(pack).await
    }

    /// The digests of all blobs.
    #[must_use]
    pub fn digests(&self) -> Vec<[u8; 32]> {
        self.index().digests()
    }

    /// The data folder that the packs belong to; `None` before the first [`Store::set_folder`].
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

    /// Notes the data folder that the packs belong to.
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

/// Whole or not at all.
fn write(packs: &Path, id: &str) -> Result<(), StoreError> {
    let (unfinished, path) = (packs.join("folder.new"), packs.join(FOLDER));
    std::fs::write(&unfinished, id)?;
    std::fs::File::open(&unfinished)?.sync_all()?;
    std::fs::rename(&unfinished, &path)?;
    Ok(std::fs::File::open(packs)?.sync_all()?)
}
