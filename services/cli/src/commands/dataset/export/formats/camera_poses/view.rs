//! The camera of a frame: intrinsics and pose.

use std::path::Path;

use cli::exit::Failure;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use spec::{Distortion, FrameRecord, Intrinsics, LensRecord};

use crate::commands::dataset::export::files::target::read_written;
use crate::commands::dataset::export::format::RECORD;
use crate::commands::dataset::export::input::frame::{Frame, untrusted};

/// A camera in the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct View {
    pub(crate) width: u64,
    pub(crate) height: u64,
    /// Behind a flat port, the intrinsics of the rays in the water.
    pub(crate) intrinsics: Intrinsics,
    /// Distortion of those rays (Brown and Conrady); `None` for a pinhole.
    pub(crate) distortion: Option<Distortion>,
    /// Rows of the matrix from camera axes (right, down, ahead, 1) to the world, meters.
    pub(crate) world_from_camera: [[f64; 4]; 4],
    /// Distance of the right camera of a stereo pair, meters.
    pub(crate) baseline_m: Option<f64>,
}

impl View {
    /// The camera of a frame whose record is in a folder.
    pub(crate) fn read(folder: &Path, frame: &Frame) -> Result<Self, Failure> {
        let name = frame.file(RECORD);
        Self::parse(name, &read_written(&folder.join(name))?)
    }

    /// The camera of a record; errors name it.
    pub(crate) fn parse(name: &str, bytes: &[u8]) -> Result<Self, Failure> {
        let record: FrameRecord = serde_json::from_slice(bytes)
            .map_err(|error| untrusted(format!("{name}, which is not a record: {error}")))?;
        let camera = record.parameters.get("camera").unwrap_or(&Value::Null);
        let pose = record.scene.as_ref().and_then(|scene| scene.world_from_camera);
        let sides = (camera["width"].as_u64(), camera["height"].as_u64());
        match (sides.0, sides.1, record.scene.as_ref(), pose) {
            (Some(width), Some(height), Some(scene), Some(world_from_camera)) => {
                let lens = scene.lens.as_ref().map(LensRecord::in_water);
                let mut intrinsics = scene.intrinsics;
                intrinsics.focal_px *= lens.map_or(1.0, |(longer, _)| longer);
                Ok(Self {
                    width,
                    height,
                    intrinsics,
                    distortion: lens.map(|(_, distortion)| distortion),
                    world_from_camera,
                    baseline_m: camera["stereo"]["baseline_m"].as_f64(),
                })
            }
            _ => Err(Failure::BadInput(format!("{name} has no pose of its camera"))),
        }
    }

    /// Columns of the rotation from camera axes to the world: right, down, ahead.
    pub(crate) fn axes(&self) -> [[f64; 3]; 3] {
        let column = |at: usize| [0, 1, 2].map(|row| self.world_from_camera[row][at]);
        [column(0), column(1), column(2)]
    }

    /// Rows of the rotation from camera axes to the world.
    pub(crate) fn rotation(&self) -> [[f64; 3]; 3] {
        let [x, y, z, _] = self.world_from_camera;
        [x, y, z].map(|[right, down, ahead, _]| [right, down, ahead])
    }

    /// Whether another view has the same camera at any pose.
    pub(crate) fn has_camera_of(&self, other: &Self) -> bool {
        let Self {
            world_from_camera, ..
        } = *self;
        *self
            == Self {
                world_from_camera,
                ..other.clone()
            }
    }

    /// Center of the camera, meters.
    pub(crate) fn position(&self) -> [f64; 3] {
        [0, 1, 2].map(|row| self.world_from_camera[row][3])
    }
}
