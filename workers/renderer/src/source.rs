//! Where the scene of a frame comes from, beside what the frame itself says.

use std::sync::Arc;

use spec::SceneFiles;

/// The bytes of an uploaded scene.
pub type SceneBytes = SceneFiles<Vec<u8>>;

/// What a slot is given beside the frame.
#[derive(Debug, Clone)]
pub enum SceneSource {
    /// Nothing: the scene is procedural or made of files of this machine.
    Local,
    /// The files of the uploaded scene that the frame names.
    Uploaded(Arc<SceneBytes>),
}
