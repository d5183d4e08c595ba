//! Uploaded scenes, fetched from the service and cached.

use std::collections::BTreeMap;
use std::sync::{Arc, MutexGuard, PoisonError};

use crate::error::RenderError;
use crate::source::SceneBytes;
use crate::worker::fetch::{fetch, fetch_bytes};
use crate::worker::held::Hold;
use crate::worker::shared::{Scenes, Shared};

/// Maximum bytes of cached scenes; a typical scene has 2 MiB.
const MOST_BYTES: usize = 256 << 20;

impl Scenes {
    /// The files of an uploaded scene.
    pub(crate) fn get(&self, shared: &Shared, hold: &Hold, id: &str) -> Result<Arc<SceneBytes>, RenderError> {
        if let Some(scene) = self.kept().get(id) {
            return Ok(Arc::clone(scene));
        }
        // Not locked during the fetch: two slots may fetch the same scene, but neither waits for the other.
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

/// Size in bytes.
fn size(scene: &Arc<SceneBytes>) -> usize {
    scene.named().map(|(_, bytes)| bytes.len()).sum()
}
