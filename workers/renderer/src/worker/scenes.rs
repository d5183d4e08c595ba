//! Uploaded scenes, fetched from the service and kept for the frames that follow.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::client::ClientError;
use imaging::geometry::Intrinsics;
use proto::message::{RangeFile, RangeKind};
use sha2::{Digest, Sha256};

use super::Shared;
use super::held::Hold;
use super::patience::persist;
use crate::error::RenderError;
use crate::source::{RangeUpload, UploadedScene};

/// Scenes are kept up to this size together; a typical one has 2 MiB.
const MOST_BYTES: usize = 256 << 20;

/// The scenes that were used last, the newest at the end. An upload never changes, so its id names its content.
#[derive(Default)]
pub(crate) struct Scenes(Mutex<Vec<(String, Arc<UploadedScene>)>>);

impl Scenes {
    /// The files of an uploaded scene.
    pub(crate) fn get(
        &self,
        shared: &Shared,
        hold: &Hold,
        id: &str,
    ) -> Result<Arc<UploadedScene>, RenderError> {
        if let Some(scene) = self.kept(id) {
            return Ok(scene);
        }
        // Not locked meanwhile: two slots that need the same scene fetch it twice, nobody waits for another's transport.
        let scene = Arc::new(fetch(shared, hold, id)?);
        self.keep(id, &scene);
        Ok(scene)
    }

    fn kept(&self, id: &str) -> Option<Arc<UploadedScene>> {
        let mut scenes = self.scenes();
        let position = scenes.iter().position(|(kept, _)| kept == id)?;
        let entry = scenes.remove(position);
        let scene = Arc::clone(&entry.1);
        scenes.push(entry);
        Some(scene)
    }

    fn keep(&self, id: &str, scene: &Arc<UploadedScene>) {
        let mut scenes = self.scenes();
        scenes.retain(|(kept, _)| kept != id);
        scenes.push((id.to_owned(), Arc::clone(scene)));
        while scenes.len() > 1 && scenes.iter().map(|(_, scene)| scene.size()).sum::<usize>() > MOST_BYTES {
            scenes.remove(0);
        }
    }

    fn scenes(&self) -> MutexGuard<'_, Vec<(String, Arc<UploadedScene>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn fetch(shared: &Shared, hold: &Hold, id: &str) -> Result<UploadedScene, RenderError> {
    let wanted = || !hold.is_lost();
    let failed = |error: ClientError| RenderError::Fetch {
        id: id.to_owned(),
        retryable: !matches!(error, ClientError::Refused { .. }),
        reason: error.to_string(),
    };
    let blob = |digest: &str| {
        let bytes = persist(&shared.stop, wanted, || shared.service.blob(digest))
            .result
            .map_err(failed)?;
        if spec::hex(&Sha256::digest(&bytes)) == digest {
            return Ok(bytes);
        }
        let reason = format!("bytes arrived that do not have the digest {digest}");
        Err(RenderError::Fetch {
            id: id.to_owned(),
            reason,
            retryable: true,
        })
    };
    let files = persist(&shared.stop, wanted, || shared.service.scene(id))
        .result
        .map_err(failed)?;
    let range = |range: &RangeFile| {
        Ok::<_, RenderError>(RangeUpload {
            bytes: blob(&range.digest)?,
            kind: match range.kind {
                RangeKind::Range => scenes::uploaded::RangeKind::Range,
                RangeKind::ZDepth => scenes::uploaded::RangeKind::ZDepth,
            },
            unit_m: range.unit_m,
            invalid_code: range.invalid_code,
        })
    };
    Ok(UploadedScene {
        rgb: blob(&files.rgb_digest)?,
        range: files.range.as_ref().map(range).transpose()?,
        intrinsics: files.intrinsics.map(|it| Intrinsics {
            focal_px: it.focal_px,
            cx: it.cx,
            cy: it.cy,
        }),
        instances: files.instances_digest.as_deref().map(blob).transpose()?,
    })
}
