//! Uploaded scenes, one for each content.

use serde_json::json;
use spec::{Intrinsics, RangeFile, RangeKind, SceneFiles};
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::cursor;
use crate::error::CatalogueError;
use crate::types::{Page, SceneRow};

pub(crate) async fn insert(
    connection: &mut SqliteConnection,
    scene: &SceneRow,
) -> Result<String, CatalogueError> {
    let files = &scene.files;
    let (range, camera) = (files.range.as_ref(), files.intrinsics.as_ref());
    sqlx::query(
        "INSERT INTO scenes (id, content_digest, rgb_digest, range_digest, range_kind, unit_m, invalid_code,
                             instances_digest, width, height, focal_px, cx, cy, created_ms)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (content_digest) DO NOTHING",
    )
    .bind(&scene.id)
    .bind(&scene.content_digest)
    .bind(&files.rgb)
    .bind(range.map(|range| &range.file))
    .bind(range.map(|range| range.kind.name()))
    .bind(range.and_then(|range| range.unit_m))
    .bind(range.and_then(|range| range.invalid_code))
    .bind(&files.instances)
    .bind(scene.width)
    .bind(scene.height)
    .bind(camera.map(|camera| camera.focal_px))
    .bind(camera.map(|camera| camera.cx))
    .bind(camera.map(|camera| camera.cy))
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
    let kind = row.try_get::<Option<&str>, _>(4)?.and_then(RangeKind::parse);
    let range = row.try_get::<Option<String>, _>(3)?.zip(kind);
    let (unit_m, invalid_code) = (row.try_get(5)?, row.try_get(6)?);
    Ok(SceneRow {
        id: row.try_get(0)?,
        content_digest: row.try_get(1)?,
        files: SceneFiles {
            rgb: row.try_get(2)?,
            range: range.map(|(file, kind)| RangeFile {
                file,
                kind,
                unit_m,
                invalid_code,
            }),
            instances: row.try_get(7)?,
            intrinsics: match (row.try_get(10)?, row.try_get(11)?, row.try_get(12)?) {
                (Some(focal_px), Some(cx), Some(cy)) => Some(Intrinsics { focal_px, cx, cy }),
                _ => None,
            },
        },
        width: row.try_get(8)?,
        height: row.try_get(9)?,
        created_ms: row.try_get::<i64, _>(13)? as u64,
    })
}
