//! The camera of a frame: intrinsics and pose.

use std::path::Path;

use cli::exit::Failure;
use serde_json::Value;
use spec::{Distortion, FrameRecord, Intrinsics, LensRecord};

use crate::commands::dataset::export::files::target::read_written;
use crate::commands::dataset::export::format::RECORD;
use crate::commands::dataset::export::input::frame::{Frame, untrusted};

/// A camera in the world.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct View {
    pub(crate) width: u64,
    pub(crate) height: u64,
    /// Behind a flat port, the intrinsics of the rays in the water.
    pub(crate) intrinsics: Intrinsics,
    /// Distortion of those rays (Brown and Conrady); `None` for a pinhole.
    pub(crate) distortion: Option<Distortion>,
    /// Rows of the matrix from camera axes (right, down, ahead, 1) to the world, meters.
    pub(crate) world_from_camera: [[f64; 4]; 4],
}

impl View {
    /// The camera of a frame whose record is in a folder.
    pub(crate) fn read(folder: &Path, frame: &Frame) -> Result<Self, Failure> {
        let name = frame.file(RECORD);
        let record: FrameRecord = serde_json::from_slice(&read_written(&folder.join(name))?)
            .map_err(|error| untrusted(format!("{name}, which is not a record: {error}")))?;
        let side = |name: &str| {
            record
                .parameters
                .pointer(&format!("/camera/{name}"))
                .and_then(Value::as_u64)
        };
        let pose = record.scene.as_ref().and_then(|scene| scene.world_from_camera);
        match (side("width"), side("height"), record.scene.as_ref(), pose) {
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

    /// Center of the camera, meters.
    pub(crate) fn position(&self) -> [f64; 3] {
        [0, 1, 2].map(|row| self.world_from_camera[row][3])
    }
}
