//! Scene data that the frame's description does not contain.

use std::sync::Arc;

use spec::SceneFiles;

/// The bytes of an uploaded scene.
pub type SceneBytes = SceneFiles<Vec<u8>>;

/// Scene data that accompanies a frame.
#[derive(Debug, Clone)]
pub enum SceneSource {
    /// None: the scene is procedural or read from local files.
    Local,
    /// The files of the uploaded scene that the frame names.
    Uploaded(Arc<SceneBytes>),
}
