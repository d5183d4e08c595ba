use std::path::{Path, PathBuf};
use std::sync::Arc;

use axum::http::StatusCode;
use client::BackupView;

use crate::clock::ordered_id;
use crate::http::failure::writing;
use crate::http::{Json, Problem, State, Topic};
use crate::operations::Operations;
use crate::processes::compute::to_the_end;

/// Prefix of a backup's folder; the rest increases from backup to backup.
const PREFIX: &str = "bak_";
/// Prefix while it is unfinished.
const UNFINISHED: &str = ".bak_";

/// Copy the catalogue and all artifacts while the service runs.
///
/// The copy is a complete data folder in `backups` of the service's. Move it away; to restore, start a service on it.
/// One backup runs at a time.
#[utoipa::path(post, path = "/v1/backups", tag = "operations", operation_id = "create_backup",
    responses((status = 201, description = "The copy is complete and on disk.", body = BackupView),
              (status = 507, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(operations): Topic<Operations>,
) -> Result<(StatusCode, Json<BackupView>), Problem> {
    // It completes even if the client disconnects, and leaves no partial copy.
    let view = to_the_end(async move { copy(&operations).await }).await?;
    Ok((StatusCode::CREATED, Json(view)))
}

async fn copy(operations: &Arc<Operations>) -> Result<BackupView, Problem> {
    operations.bytes.space.room().await?;
    // No bytes of a copied row may be deleted before they are copied.
    let _alone = operations.bytes.upkeep.lock().await;
    let backups = operations.data.join("backups");
    let name = format!("{PREFIX}{}", ordered_id().simple());
    let (unfinished, folder) = (backups.join(format!(".{name}")), backups.join(&name));
    tokio::fs::create_dir_all(&unfinished)
        .await
        .map_err(|error| Problem::internal(&error))?;
    let copied = async {
        operations
            .catalogue
            .backup(&unfinished.join("catalogue.sqlite"))
            .await?;
        operations.bytes.store.backup(&unfinished).await?;
        let (styles, copy) = (Arc::clone(&operations.styles), unfinished.clone());
        let copied = operations
            .processes
            .compute
            .run(move || styles.copy_to(&copy))
            .await?;
        copied.map_err(|error| writing(&error))?;
        tokio::fs::rename(&unfinished, &folder)
            .await
            .map_err(|error| Problem::internal(&error))?;
        let counted = folder.clone();
        let counted = tokio::task::spawn_blocking(move || below(&counted)).await;
        counted
            .map_err(|error| Problem::internal(&error))?
            .map_err(|error| Problem::internal(&error))
    };
    let copied: Result<u64, Problem> = copied.await;
    if copied.is_err()
        && let Err(error) = tokio::fs::remove_dir_all(&unfinished).await
    {
        tracing::warn!(folder = %unfinished.display(), %error, "could not remove a failed backup");
    }
    let bytes = copied?;
    tracing::info!(folder = %folder.display(), bytes, "backup made");
    Ok(BackupView {
        folder: folder.display().to_string(),
        bytes,
    })
}

/// The newest backup of a data folder.
///
/// # Errors
/// The folder cannot be read.
pub(crate) fn newest(data: &Path) -> std::io::Result<Option<PathBuf>> {
    let backups = data.join("backups");
    if !backups.is_dir() {
        return Ok(None);
    }
    let mut newest: Option<PathBuf> = None;
    for entry in std::fs::read_dir(backups)? {
        let entry = entry?;
        let is_backup = entry.file_name().to_string_lossy().starts_with(PREFIX);
        if is_backup && newest.as_ref().is_none_or(|known| *known < entry.path()) {
            newest = Some(entry.path());
        }
    }
    Ok(newest)
}

/// Removes unfinished backups of killed services; returns the freed bytes. No other backup may be running.
///
/// # Errors
/// The folder cannot be read or changed.
pub fn clear_unfinished(data: &Path) -> std::io::Result<u64> {
    let backups = data.join("backups");
    let mut bytes = 0;
    if !backups.is_dir() {
        return Ok(0);
    }
    for entry in std::fs::read_dir(backups)? {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
            bytes += below(&entry.path())?;
            std::fs::remove_dir_all(entry.path())?;
            tracing::info!(folder = %entry.path().display(), "removed an unfinished backup");
        }
    }
    Ok(bytes)
}

/// Bytes of all files below a folder.
fn below(folder: &Path) -> std::io::Result<u64> {
    let (mut bytes, mut open) = (0, vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder)? {
            let entry = entry?;
            match entry.metadata()? {
                about if about.is_dir() => open.push(entry.path()),
                about => bytes += about.len(),
            }
        }
    }
    Ok(bytes)
}
