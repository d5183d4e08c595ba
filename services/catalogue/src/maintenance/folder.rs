//! The identity of the data folder, and whether its packs are referenced.

use sqlx::Row;

use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::digests::tables::FOLDER;
use crate::error::CatalogueError;

impl Catalogue {
    /// The folder's id.
    ///
    /// # Errors
    /// [`CatalogueError::Damaged`].
    pub async fn folder(&self) -> Result<String, CatalogueError> {
        let row = sqlx::query("SELECT id, row_digest FROM folder WHERE id > '' LIMIT 1")
            .fetch_optional(&mut *self.reader().await?)
            .await?;
        let row = row.ok_or_else(|| CatalogueError::damaged("the id of the folder".to_owned()))?;
        FOLDER.verify(&row, Side::Reader)?;
        Ok(row.try_get(0)?)
    }

    /// Whether any row refers to bytes in the packs.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn names_bytes(&self) -> Result<bool, CatalogueError> {
        let names = sqlx::query_scalar(
            "SELECT EXISTS (SELECT 1 FROM scenes) OR EXISTS (SELECT 1 FROM artifacts WHERE tar_offset IS NULL)",
        );
        Ok(names.fetch_one(&mut *self.reader().await?).await?)
    }

    /// Those of these digests that no row names.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn unnamed(&self, digests: &[String]) -> Result<Vec<String>, CatalogueError> {
        let unnamed = sqlx::query_scalar(
            "SELECT value FROM json_each(?)
             WHERE NOT EXISTS (SELECT 1 FROM artifacts a WHERE a.digest = value AND a.tar_offset IS NULL)
               AND NOT EXISTS (SELECT 1 FROM scenes WHERE rgb_digest = value)
               AND NOT EXISTS (SELECT 1 FROM scenes WHERE range_digest = value)
               AND NOT EXISTS (SELECT 1 FROM scenes WHERE instances_digest = value)",
        );
        let unnamed = unnamed.bind(serde_json::to_string(digests)?);
        Ok(unnamed.fetch_all(&mut *self.reader().await?).await?)
    }

    /// Puts digests on the list of orphans, where [`Catalogue::orphans`] looks again whether a row names them.
    ///
    /// # Errors
    /// [`CatalogueError::Full`].
    pub async fn add_orphans(&self, digests: Vec<String>) -> Result<(), CatalogueError> {
        let digests = serde_json::to_string(&digests)?;
        self.write(|c| {
            Box::pin(async move {
                sqlx::query("INSERT OR IGNORE INTO orphans (digest) SELECT value FROM json_each(?)")
                    .bind(digests)
                    .execute(c)
                    .await?;
                Ok(())
            })
        })
        .await
    }
}
