//! Uploaded scenes, one for each content.

use client::Page;
use spec::{Intrinsics, RangeFile, RangeKind, SceneFiles};
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::catalogue::Catalogue;
use crate::digests::row_digests::Side;
use crate::digests::tables::{SCENES, scene_columns};
use crate::error::CatalogueError;
use crate::query::cells::Cells;
use crate::query::cursor;
use crate::query::list_page::list_page;
use crate::types::SceneRow;

/// The columns of a row, with the digest over them.
macro_rules! digested {
    () => {
        concat!(scene_columns!(), ", row_digest")
    };
}

impl Catalogue {
    /// Stores a scene, unless one of the same content is stored. Returns the row of the one that is, and whether it is
    /// new.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn insert_scene(&self, scene: SceneRow) -> Result<(SceneRow, bool), CatalogueError> {
        self.write(move |c| Box::pin(async move { insert(c, &scene).await }))
            .await
    }

    /// A scene.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn scene(&self, id: &str) -> Result<Option<SceneRow>, CatalogueError> {
        get(&mut *self.reader().await?, id).await
    }

    /// Those of these scenes that there are, in no order.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn scenes_of(&self, ids: &[String]) -> Result<Vec<SceneRow>, CatalogueError> {
        if ids.is_empty() {
            return Ok(Vec::new());
        }
        let found = sqlx::query(concat!(
            "SELECT ",
            digested!(),
            " FROM scenes WHERE id IN (SELECT value FROM json_each(?))"
        ));
        let found = found.bind(serde_json::to_string(ids)?);
        let rows = found.fetch_all(&mut *self.reader().await?).await?;
        rows.iter().map(|row| verified(row, Side::Reader)).collect()
    }

    /// The first of these scenes that is not there.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub async fn missing_scene(&self, ids: &[String]) -> Result<Option<String>, CatalogueError> {
        if ids.is_empty() {
            return Ok(None);
        }
        let missing = sqlx::query_scalar(
            "SELECT value FROM json_each(?) WHERE value NOT IN (SELECT id FROM scenes) LIMIT 1",
        );
        let missing = missing.bind(serde_json::to_string(ids)?);
        Ok(missing.fetch_optional(&mut *self.reader().await?).await?)
    }

    /// Removes a scene, from its collections too; the digests of its files become orphans.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`]; [`CatalogueError::InUse`] while a job has frames of it.
    pub async fn delete_scene(&self, id: &str) -> Result<(), CatalogueError> {
        let id = id.to_owned();
        self.write(move |c| Box::pin(async move { delete(c, &id).await }))
            .await
    }

    /// Scenes, newest first.
    ///
    /// # Errors
    /// [`CatalogueError::Cursor`].
    pub async fn scenes(&self, limit: u32, cursor: Option<String>) -> Result<Page<SceneRow>, CatalogueError> {
        let identity = cursor::query_identity(&[Some("scenes")]);
        let rows = sqlx::query(concat!(
            "SELECT ",
            digested!(),
            " FROM scenes WHERE ?1 IS NULL OR id < ?1 ORDER BY id DESC LIMIT ?2"
        ))
        .bind(cursor::read_id(&identity, cursor.as_deref())?)
        .bind(i64::from(limit) + 1)
        .fetch_all(&mut *self.reader().await?)
        .await?;
        list_page(&identity, &rows, limit, &self.damage, |row| {
            verified(row, Side::Reader)
        })
    }
}

pub(crate) async fn get(
    connection: &mut SqliteConnection,
    id: &str,
) -> Result<Option<SceneRow>, CatalogueError> {
    let found = sqlx::query(concat!("SELECT ", digested!(), " FROM scenes WHERE id = ?"));
    let found = found.bind(id).fetch_optional(connection).await?;
    found.as_ref().map(|row| verified(row, Side::Reader)).transpose()
}

async fn insert(
    connection: &mut SqliteConnection,
    scene: &SceneRow,
) -> Result<(SceneRow, bool), CatalogueError> {
    let files = &scene.files;
    let (range, camera) = (files.range.as_ref(), files.intrinsics.as_ref());
    let stored = sqlx::query(concat!(
        "INSERT INTO scenes (",
        scene_columns!(),
        ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (content_digest) DO NOTHING RETURNING ",
        scene_columns!(),
    ))
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
    .bind(scene.created_at.0 as i64)
    .bind(files.classes.as_ref().map(serde_json::to_string).transpose()?)
    .bind(files.world_from_camera.as_ref().map(serde_json::to_string).transpose()?)
    .bind(files.hfov_deg)
    .bind(files.scale)
    .fetch_optional(&mut *connection)
    .await?;
    if let Some(stored) = stored {
        return Ok((row(&stored)?, true));
    }
    let earlier = sqlx::query(concat!(
        "SELECT ",
        digested!(),
        " FROM scenes WHERE content_digest = ?"
    ));
    let earlier = earlier.bind(&scene.content_digest).fetch_one(connection).await?;
    Ok((verified(&earlier, Side::Writer)?, false))
}

async fn delete(connection: &mut SqliteConnection, id: &str) -> Result<(), CatalogueError> {
    // Ids are never made twice: a description that holds one means this scene.
    let jobs: Vec<String> = sqlx::query_scalar(
        "SELECT id FROM jobs WHERE instr(spec, ?) > 0 AND id NOT IN (SELECT job_id FROM deletions) ORDER BY id",
    )
    .bind(format!("\"{id}\""))
    .fetch_all(&mut *connection)
    .await?;
    if let [job, others @ ..] = jobs.as_slice() {
        return Err(CatalogueError::InUse {
            what: "scene",
            name: id.to_owned(),
            job: job.clone(),
            others: others.len(),
        });
    }
    sqlx::query("DELETE FROM collection_scenes WHERE scene_id = ?")
        .bind(id)
        .execute(&mut *connection)
        .await?;
    let gone: Option<(String, Option<String>, Option<String>)> = sqlx::query_as(
        "DELETE FROM scenes WHERE id = ? RETURNING rgb_digest, range_digest, instances_digest",
    )
    .bind(id)
    .fetch_optional(&mut *connection)
    .await?;
    let (rgb, range, instances) = gone.ok_or_else(|| CatalogueError::not_found("scene", id))?;
    for digest in [Some(rgb), range, instances].into_iter().flatten() {
        sqlx::query("INSERT OR IGNORE INTO orphans (digest) VALUES (?)")
            .bind(digest)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

fn verified(found: &SqliteRow, side: Side) -> Result<SceneRow, CatalogueError> {
    SCENES.verify(found, side)?;
    Ok(row(found)?)
}

fn row(row: &SqliteRow) -> Result<SceneRow, sqlx::Error> {
    let mut cells = Cells::new(row);
    let (id, content_digest, rgb) = (cells.take()?, cells.take()?, cells.take()?);
    let (file, kind) = (cells.take::<Option<String>>()?, cells.take::<Option<&str>>()?);
    let (unit_m, invalid_code) = (cells.take()?, cells.take()?);
    let range = file.zip(kind.and_then(RangeKind::parse));
    let (instances, width, height) = (cells.take()?, cells.take()?, cells.take()?);
    let intrinsics = match (cells.take()?, cells.take()?, cells.take()?) {
        (Some(focal_px), Some(cx), Some(cy)) => Some(Intrinsics { focal_px, cx, cy }),
        _ => None,
    };
    let created_at = cells.time()?;
    let classes = cells.json()?;
    let world_from_camera = cells.json()?;
    let (hfov_deg, scale) = (cells.take()?, cells.take()?);
    Ok(SceneRow {
        id,
        content_digest,
        files: SceneFiles {
            rgb,
            range: range.map(|(file, kind)| RangeFile {
                file,
                kind,
                unit_m,
                invalid_code,
            }),
            instances,
            intrinsics,
            classes,
            world_from_camera,
            hfov_deg,
            scale,
        },
        width,
        height,
        created_at,
    })
}
