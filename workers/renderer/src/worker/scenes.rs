//! Uploaded scenes, fetched from the service and kept for the frames that follow.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Shared;
use super::fetch::{fetch, fetch_bytes};
use super::held::Hold;
use crate::error::RenderError;
use crate::source::SceneBytes;

/// Scenes are kept up to this size together; a typical one has 2 MiB.
const MOST_BYTES: usize = 256 << 20;

/// The scenes that were used last. An upload never changes, so its id names its content.
#[derive(Default)]
pub(crate) struct Scenes(Mutex<BTreeMap<String, Arc<SceneBytes>>>);

impl Scenes {
    /// The files of an uploaded scene.
    pub(crate) fn get(&self, shared: &Shared, hold: &Hold, id: &str) -> Result<Arc<SceneBytes>, RenderError> {
        if let Some(scene) = self.kept().get(id) {
            return Ok(Arc::clone(scene));
        }
        // Not locked meanwhile: two slots that need the same scene may fetch it twice, and neither waits for the other.
        let what = &format!("scene `{id}`");
        let files = fetch(shared, hold, what, || shared.client.scene(id))?;
        let blob = |digest: &String| fetch_bytes(shared, hold, what, digest, || shared.client.blob(digest));
        let scene = Arc::new(files.try_map(blob)?);
        let mut kept = self.kept();
        if kept.values().map(size).sum::<usize>() + size(&scene) > MOST_BYTES {
            kept.clear();
        }
        kept.insert(id.to_owned(), Arc::clone(&scene));
        Ok(scene)
    }

    fn kept(&self) -> MutexGuard<'_, BTreeMap<String, Arc<SceneBytes>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Bytes in memory.
fn size(scene: &Arc<SceneBytes>) -> usize {
    scene.named().map(|(_, bytes)| bytes.len()).sum()
}
