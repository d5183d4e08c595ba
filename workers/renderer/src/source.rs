//! Where the scene of a frame comes from, beside what the frame itself says.

use std::sync::Arc;

use imaging::geometry::Intrinsics;
use scenes::uploaded::RangeKind;

/// What a slot is given beside the frame.
#[derive(Debug, Clone)]
pub enum SceneSource {
    /// Nothing: the scene is procedural or made of files of this machine.
    Local,
    /// The files of the uploaded scene that the frame names.
    Uploaded(Arc<UploadedScene>),
}

/// The files of an uploaded scene.
#[derive(Debug, Clone)]
pub struct UploadedScene {
    /// The picture: PNG, JPEG, WebP or NPY.
    pub rgb: Vec<u8>,
    /// The range file.
    pub range: Option<RangeUpload>,
    /// The camera, if the upload said it.
    pub intrinsics: Option<Intrinsics>,
    /// The instance mask.
    pub instances: Option<Vec<u8>>,
}

/// A range file with what its values mean.
#[derive(Debug, Clone)]
pub struct RangeUpload {
    /// The file.
    pub bytes: Vec<u8>,
    /// Distances along the line of sight or along the optical axis.
    pub kind: RangeKind,
    /// Metres of one unit.
    pub unit_m: Option<f64>,
    /// The code that means "no return".
    pub invalid_code: Option<u16>,
}

impl UploadedScene {
    /// Bytes in memory.
    #[must_use]
    pub fn size(&self) -> usize {
        let range = self.range.as_ref().map_or(0, |range| range.bytes.len());
        self.rgb.len() + range + self.instances.as_ref().map_or(0, Vec::len)
    }
}
