//! Uploaded scenes, fetched from the service and kept for the frames that follow.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::client::ClientError;

use super::Shared;
use super::held::Hold;
use super::patience::persist;
use crate::error::RenderError;
use crate::source::SceneBytes;

/// Scenes are kept up to this size together; a typical one has 2 MiB.
const MOST_BYTES: usize = 256 << 20;

/// The scenes that were used last, the newest at the end. An upload never changes, so its id names its content.
#[derive(Default)]
pub(crate) struct Scenes(Mutex<Vec<(String, Arc<SceneBytes>)>>);

impl Scenes {
    /// The files of an uploaded scene.
    pub(crate) fn get(&self, shared: &Shared, hold: &Hold, id: &str) -> Result<Arc<SceneBytes>, RenderError> {
        if let Some(scene) = self.kept(id) {
            return Ok(scene);
        }
        // Not locked meanwhile: two slots that need the same scene may fetch it twice, and neither waits for the other.
        let scene = Arc::new(fetch(shared, hold, id)?);
        self.keep(id, &scene);
        Ok(scene)
    }

    fn kept(&self, id: &str) -> Option<Arc<SceneBytes>> {
        let mut scenes = self.scenes();
        let position = scenes.iter().position(|(kept, _)| kept == id)?;
        let entry = scenes.remove(position);
        let scene = Arc::clone(&entry.1);
        scenes.push(entry);
        Some(scene)
    }

    fn keep(&self, id: &str, scene: &Arc<SceneBytes>) {
        let mut scenes = self.scenes();
        scenes.retain(|(kept, _)| kept != id);
        scenes.push((id.to_owned(), Arc::clone(scene)));
        while scenes.len() > 1 && scenes.iter().map(|(_, scene)| size(scene)).sum::<usize>() > MOST_BYTES {
            scenes.remove(0);
        }
    }

    fn scenes(&self) -> MutexGuard<'_, Vec<(String, Arc<SceneBytes>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Bytes in memory.
fn size(scene: &SceneBytes) -> usize {
    scene.named().map(|(_, bytes)| bytes.len()).sum()
}

fn fetch(shared: &Shared, hold: &Hold, id: &str) -> Result<SceneBytes, RenderError> {
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
        if spec::sha256(&bytes) == digest {
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
    files.try_map(|digest| blob(digest))
}
