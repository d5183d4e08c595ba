//! Waters of the users' own, each under a name of its own.

use sqlx::Row;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::Catalogue;
use crate::error::CatalogueError;

/// A water of a user's own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaterRow {
    /// Its name.
    pub name: String,
    /// As it was submitted, JSON.
    pub description: String,
    /// When, in Unix milliseconds.
    pub created_ms: u64,
}

impl Catalogue {
    /// Stores a water unless its name is taken; answers whether it was stored.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_water(&self, water: WaterRow) -> Result<bool, CatalogueError> {
        self.write(move |c| Box::pin(async move { insert(c, &water).await }))
            .await
    }

    /// All waters in the order of their names.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn waters(&self) -> Result<Vec<WaterRow>, CatalogueError> {
        let rows = sqlx::query("SELECT name, description, created_ms FROM waters ORDER BY name")
            .fetch_all(&mut *self.reader().await?)
            .await?;
        let row = |row: sqlx::sqlite::SqliteRow| -> Result<WaterRow, sqlx::Error> {
            Ok(WaterRow {
                name: row.try_get(0)?,
                description: row.try_get(1)?,
                created_ms: row.try_get::<i64, _>(2)? as u64,
            })
        };
        Ok(rows.into_iter().map(row).collect::<Result<_, _>>()?)
    }

    /// Deletes a water; answers whether there was one. Jobs hold its numbers and go on.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn delete_water(&self, name: &str) -> Result<bool, CatalogueError> {
        let name = name.to_owned();
        self.write(move |c| Box::pin(async move { delete(c, &name).await }))
            .await
    }
}

async fn insert(connection: &mut SqliteConnection, water: &WaterRow) -> Result<bool, CatalogueError> {
    let done = sqlx::query(
        "INSERT INTO waters (name, description, created_ms) VALUES (?, ?, ?) ON CONFLICT (name) DO NOTHING",
    )
    .bind(&water.name)
    .bind(&water.description)
    .bind(water.created_ms as i64)
    .execute(connection)
    .await?;
    Ok(done.rows_affected() == 1)
}

async fn delete(connection: &mut SqliteConnection, name: &str) -> Result<bool, CatalogueError> {
    let done = sqlx::query("DELETE FROM waters WHERE name = ?")
        .bind(name)
        .execute(connection)
        .await?;
    Ok(done.rows_affected() == 1)
}
