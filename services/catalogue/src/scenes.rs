//! Uploaded scenes, one for each content.

use serde_json::json;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::cursor;
use crate::error::CatalogueError;
use crate::types::{Page, SceneRow};

pub(crate) async fn insert(
    connection: &mut SqliteConnection,
    scene: &SceneRow,
) -> Result<String, CatalogueError> {
    sqlx::query(
        "INSERT INTO scenes (id, content_digest, rgb_digest, range_digest, range_kind, unit_m, invalid_code,
                             instances_digest, width, height, focal_px, cx, cy, created_ms)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (content_digest) DO NOTHING",
    )
    .bind(&scene.id)
    .bind(&scene.content_digest)
    .bind(&scene.rgb_digest)
    .bind(&scene.range_digest)
    .bind(&scene.range_kind)
    .bind(scene.unit_m)
    .bind(scene.invalid_code)
    .bind(&scene.instances_digest)
    .bind(scene.width)
    .bind(scene.height)
    .bind(scene.focal_px)
    .bind(scene.cx)
    .bind(scene.cy)
    .bind(scene.created_ms as i64)
    .execute(&mut *connection)
    .await?;
    let id = sqlx::query_scalar("SELECT id FROM scenes WHERE content_digest = ?")
        .bind(&scene.content_digest)
        .fetch_one(connection)
        .await?;
    Ok(id)
}

pub(crate) async fn get(
    connection: &mut SqliteConnection,
    id: &str,
) -> Result<Option<SceneRow>, CatalogueError> {
    let found = sqlx::query(
        "SELECT id, content_digest, rgb_digest, range_digest, range_kind, unit_m, invalid_code, instances_digest, width,
                height, focal_px, cx, cy, created_ms
         FROM scenes WHERE id = ?",
    )
    .bind(id)
    .fetch_optional(connection)
    .await?;
    Ok(found.as_ref().map(row).transpose()?)
}

pub(crate) async fn list(
    connection: &mut SqliteConnection,
    limit: u32,
    cursor: Option<&str>,
) -> Result<Page<SceneRow>, CatalogueError> {
    let question = cursor::question(&[Some("scenes")]);
    let before = match cursor {
        Some(text) => Some(
            cursor::read(&question, text)?
                .as_str()
                .ok_or(CatalogueError::Cursor)?
                .to_owned(),
        ),
        None => None,
    };
    let rows = sqlx::query(
        "SELECT id, content_digest, rgb_digest, range_digest, range_kind, unit_m, invalid_code, instances_digest, width,
                height, focal_px, cx, cy, created_ms
         FROM scenes WHERE ?1 IS NULL OR id < ?1 ORDER BY id DESC LIMIT ?2",
    )
    .bind(before)
    .bind(i64::from(limit) + 1)
    .fetch_all(connection)
    .await?;
    let mut items = rows.iter().map(row).collect::<Result<Vec<_>, _>>()?;
    let more = items.len() > limit as usize;
    items.truncate(limit as usize);
    let next_cursor = items
        .last()
        .filter(|_| more)
        .map(|scene| cursor::write(&question, &json!(scene.id)));
    Ok(Page { items, next_cursor })
}

fn row(row: &SqliteRow) -> Result<SceneRow, sqlx::Error> {
    Ok(SceneRow {
        id: row.try_get(0)?,
        content_digest: row.try_get(1)?,
        rgb_digest: row.try_get(2)?,
        range_digest: row.try_get(3)?,
        range_kind: row.try_get(4)?,
        unit_m: row.try_get(5)?,
        invalid_code: row.try_get(6)?,
        instances_digest: row.try_get(7)?,
        width: row.try_get(8)?,
        height: row.try_get(9)?,
        focal_px: row.try_get(10)?,
        cx: row.try_get(11)?,
        cy: row.try_get(12)?,
        created_ms: row.try_get::<i64, _>(13)? as u64,
    })
}
