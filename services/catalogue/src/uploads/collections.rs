//! Collections of uploaded scenes.

use client::{CollectionRow, CollectionScene};
use sqlx::Row;

use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::digests::tables::COLLECTION_SCENES;
use crate::error::CatalogueError;
use crate::uploads::scenes;

impl Catalogue {
    /// Adds a scene to a collection under a name, or replaces the one of this name. Returns false, without a change, if the collection
    /// has `most` scenes under other names.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn collect_scene(
        &self,
        collection: &str,
        name: &str,
        scene_id: &str,
        most: u64,
    ) -> Result<bool, CatalogueError> {
        let [collection, name, id] = [collection, name, scene_id].map(str::to_owned);
        self.write(move |c| {
            Box::pin(async move {
                let others: i64 = sqlx::query_scalar(
                    "SELECT count(*) FROM collection_scenes WHERE collection = ? AND name != ?",
                )
                .bind(&collection)
                .bind(&name)
                .fetch_one(&mut *c)
                .await?;
                if others as u64 >= most {
                    return Ok(false);
                }
                sqlx::query(
                    "INSERT OR REPLACE INTO collection_scenes (collection, name, scene_id) VALUES (?, ?, ?)",
                )
                .bind(collection)
                .bind(name)
                .bind(id)
                .execute(c)
                .await?;
                Ok(true)
            })
        })
        .await
    }

    /// All collections by name.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn collections(&self) -> Result<Vec<CollectionRow>, CatalogueError> {
        let rows: Vec<(String, i64)> = sqlx::query_as(
            "SELECT collection, count(*) FROM collection_scenes GROUP BY collection ORDER BY collection",
        )
        .fetch_all(&mut *self.reader().await?)
        .await?;
        Ok(rows
            .into_iter()
            .map(|(name, scenes)| CollectionRow {
                name,
                scenes: scenes as u64,
            })
            .collect())
    }

    /// The scenes of a collection in their order; empty if it does not exist.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn collection(&self, name: &str) -> Result<Vec<CollectionScene>, CatalogueError> {
        let mut reader = self.reader().await?;
        let rows = sqlx::query(
            "SELECT collection, name, scene_id, row_digest FROM collection_scenes WHERE collection = ? ORDER BY name",
        )
        .bind(name)
        .fetch_all(&mut *reader)
        .await?;
        let mut members = Vec::with_capacity(rows.len());
        for row in &rows {
            COLLECTION_SCENES.verify(row, Side::Reader)?;
            let (name, id): (String, String) = (row.try_get(1)?, row.try_get(2)?);
            let scene = scenes::get(&mut reader, &id).await?;
            let scene = scene.ok_or_else(|| CatalogueError::damaged(format!("scene {id}")))?;
            members.push(CollectionScene {
                name,
                id,
                width: scene.width,
                height: scene.height,
                range_kind: scene.files.range.map(|range| range.kind.name().to_owned()),
                instances: scene.files.instances.is_some(),
            });
        }
        Ok(members)
    }

    /// Removes a collection, whose scenes stay. Returns whether there was one.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn delete_collection(&self, name: &str) -> Result<bool, CatalogueError> {
        let name = name.to_owned();
        self.write(move |c| {
            Box::pin(async move {
                let gone = sqlx::query("DELETE FROM collection_scenes WHERE collection = ?")
                    .bind(name)
                    .execute(c)
                    .await?;
                Ok(gone.rows_affected() > 0)
            })
        })
        .await
    }
}
