//! The files of a non-procedural scene: image with range, mask and camera.

use imaging::geometry::Intrinsics;
use serde::{Deserialize, Serialize};

use crate::classes::Classes;
use crate::scene_parts::SceneParts;

/// The files of a scene. `T` represents a file: path, digest or bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneFiles<T> {
    /// The image: PNG, JPEG, WebP, BMP, TIFF, NPY of shape [height, width, 3], or EXR.
    pub rgb: T,
    /// Range or z-depth.
    pub range: Option<RangeFile<T>>,
    /// Instance of each pixel, 0 = background: whole numbers of 0 to 65535 in a gray or palette picture or an array.
    pub instances: Option<T>,
    /// The camera, if known.
    pub intrinsics: Option<Intrinsics>,
    /// Classes of the objects in the instance mask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub classes: Option<Classes>,
    /// Camera pose: rows of the matrix from camera axes (right, down, ahead, 1) to the world, meters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world_from_camera: Option<[[f64; 4]; 4]>,
    /// Horizontal field of view as given for the camera, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hfov_deg: Option<f64>,
    /// Factor from the floats of the image to linear light; 1 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
}

/// A distance map: a gray picture, an array, or a channel of an EXR file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RangeFile<T> {
    /// The file.
    pub file: T,
    /// Kind of distance.
    pub kind: RangeKind,
    /// Meters per unit of the file. Required for integer codes; 1 by default for floats.
    pub unit_m: Option<f64>,
    /// The value of a hole. Required for integer codes; non-finite floats are always holes.
    pub invalid_code: Option<u16>,
}

/// Kind of distance in a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RangeKind {
    /// Along the line of sight.
    Range,
    /// Along the optical axis, as from depth cameras.
    ZDepth,
}

impl RangeKind {
    /// Its name, also of the upload field.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Range => "range",
            Self::ZDepth => "z_depth",
        }
    }

    /// Parses a kind.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        [Self::Range, Self::ZDepth]
            .into_iter()
            .find(|kind| kind.name() == name)
    }
}

impl<T> SceneFiles<T> {
    /// Maps each file, in the order image, range, mask.
    ///
    /// # Errors
    /// The first error of `change`.
    pub fn try_map<'a, U, E>(
        &'a self,
        mut change: impl FnMut(&'a T) -> Result<U, E>,
    ) -> Result<SceneFiles<U>, E> {
        Ok(SceneFiles {
            rgb: change(&self.rgb)?,
            range: match &self.range {
                None => None,
                Some(range) => Some(RangeFile {
                    file: change(&range.file)?,
                    kind: range.kind,
                    unit_m: range.unit_m,
                    invalid_code: range.invalid_code,
                }),
            },
            instances: self.instances.as_ref().map(change).transpose()?,
            intrinsics: self.intrinsics,
            classes: self.classes.clone(),
            world_from_camera: self.world_from_camera,
            hfov_deg: self.hfov_deg,
            scale: self.scale,
        })
    }

    /// The parts of the scene.
    #[must_use]
    pub fn parts(&self) -> SceneParts {
        SceneParts {
            range: self.range.is_some(),
            instances: self.instances.is_some(),
            surfaces: false,
            camera: self.intrinsics.is_some(),
        }
    }

    /// The files with their names: `rgb`, `range` (of either kind), `instances`.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &T)> {
        let range = self.range.as_ref().map(|range| ("range", &range.file));
        let instances = self.instances.as_ref().map(|file| ("instances", file));
        [Some(("rgb", &self.rgb)), range, instances].into_iter().flatten()
    }
}
