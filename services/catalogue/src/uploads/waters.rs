//! Custom waters by name.

use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::digests::tables::WATERS;
use crate::error::CatalogueError;
use crate::query::cells::Cells;
use client::UnixMs;

/// A custom water.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaterRow {
    /// Its name.
    pub name: String,
    /// As it was submitted, JSON.
    pub description: String,
    /// When.
    pub created_at: UnixMs,
}

impl Catalogue {
    /// Stores a water unless its name is taken; returns whether it was stored.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_water(&self, water: WaterRow) -> Result<bool, CatalogueError> {
        self.write(move |c| {
            Box::pin(async move {
                let done = sqlx::query(
                    "INSERT INTO waters (name, description, created_ms) VALUES (?, ?, ?) ON CONFLICT (name) DO NOTHING",
                );
                let done = done
                    .bind(water.name)
                    .bind(water.description)
                    .bind(water.created_at.0 as i64);
                Ok(done.execute(c).await?.rows_affected() == 1)
            })
        })
        .await
    }

    /// All waters in the order of their names. Damaged ones are noted and left out.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn waters(&self) -> Result<Vec<WaterRow>, CatalogueError> {
        let rows = sqlx::query("SELECT name, description, created_ms, row_digest FROM waters ORDER BY name")
            .fetch_all(&mut *self.reader().await?)
            .await?;
        let water = |row| {
            WATERS.verify(row, Side::Reader)?;
            let mut cells = Cells::new(row);
            Ok(WaterRow {
                name: cells.take()?,
                description: cells.take()?,
                created_at: cells.time()?,
            })
        };
        rows.iter()
            .filter_map(|row| self.unless_damaged(water(row)))
            .collect()
    }

    /// Deletes a water; returns whether it existed. Jobs keep its values.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn delete_water(&self, name: &str) -> Result<bool, CatalogueError> {
        let name = name.to_owned();
        self.write(move |c| {
            Box::pin(async move {
                let done = sqlx::query("DELETE FROM waters WHERE name = ?").bind(name);
                Ok(done.execute(c).await?.rows_affected() == 1)
            })
        })
        .await
    }
}
