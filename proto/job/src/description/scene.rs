//! The scene of a frame.

use serde::Deserialize;
use spec_derive::Described;

use crate::inhabited::{Ground, Life};
use crate::scene_files::{RangeFile, RangeKind, SceneFiles};
use crate::schema::EXACT;

/// Source of radiance and range.
#[derive(Debug, Clone, PartialEq, Deserialize, Described)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Scene {
    /// Rendered from a seed.
    Procedural {
        /// family of scenes
        #[field(names = Family)]
        family: String,
        /// seed of the scene, independent of the job's seed
        #[field(within(0, EXACT), default = 0)]
        seed: u64,
        /// lighting of its surfaces
        #[field(default = "water")]
        lighting: SceneLighting,
        /// growth, animals and hanging objects; none by default
        life: Option<Life>,
        /// scour and grain of the bottom; an even bottom by default
        ground: Option<Ground>,
    },
    /// Uploaded through the API.
    Uploaded {
        /// uploaded scene, with its own image size
        #[field(names = SceneId)]
        id: String,
        /// lighting of its surfaces
        #[field(default = "in_air")]
        lighting: SceneLighting,
    },
    /// Files of this machine; only for rendering without a service.
    Files {
        /// PNG, JPEG, WebP, NPY or EXR image
        #[field(names = Path)]
        rgb: String,
        /// distances along the line of sight
        #[field(names = Path)]
        range: Option<String>,
        /// distances along the optical axis, instead of `range`
        #[field(names = Path, excludes("range"))]
        z_depth: Option<String>,
        /// instance of each pixel, 0 = background
        #[field(names = Path)]
        instances: Option<String>,
        /// JSON with the class of each instance
        #[field(names = Path, needs("instances"))]
        classes: Option<String>,
        /// meters per unit of the range file
        #[field(above(0.0, 1e6), unit = "m", needs("range", "z_depth"))]
        unit_m: Option<f64>,
        /// code for a missing return in the range file
        #[field(within(0, 65_535), needs("range", "z_depth"))]
        invalid_code: Option<u16>,
        /// lighting of its surfaces
        #[field(default = "in_air")]
        lighting: SceneLighting,
    },
    /// A collection of uploaded scenes.
    Collection {
        /// name of the collection
        #[field(fixed, names = Collection)]
        name: String,
        /// true: use all scenes in turn, `count` frames of each; false: draw a scene for each frame
        #[field(fixed, default = true)]
        each: bool,
        /// ids of its scenes when the job was accepted; filled in
        #[field(names = SceneId)]
        id: Option<String>,
        /// lighting of its surfaces
        #[field(default = "in_air")]
        lighting: SceneLighting,
    },
}

/// Lighting of a scene's surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum SceneLighting {
    /// The image contains its illumination, as a photograph in air does.
    InAir,
    /// The image is reflectance, lit by the daylight and the lamps in the water.
    Water,
}

impl Scene {
    /// Lighting of its surfaces.
    #[must_use]
    pub fn lighting(&self) -> SceneLighting {
        let (Self::Procedural { lighting, .. }
        | Self::Uploaded { lighting, .. }
        | Self::Files { lighting, .. }
        | Self::Collection { lighting, .. }) = self;
        *lighting
    }

    /// Id of the uploaded scene, if it is one.
    #[must_use]
    pub fn uploaded_id(&self) -> Option<&str> {
        match self {
            Self::Uploaded { id, .. } | Self::Collection { id: Some(id), .. } => Some(id),
            _ => None,
        }
    }

    /// File paths of a local scene, without its classes.
    #[must_use]
    pub fn files(&self) -> Option<SceneFiles<&str>> {
        let Self::Files {
            rgb,
            range,
            z_depth,
            instances,
            unit_m,
            invalid_code,
            ..
        } = self
        else {
            return None;
        };
        let path = match (range, z_depth) {
            (Some(path), _) => Some((path, RangeKind::Range)),
            (None, Some(path)) => Some((path, RangeKind::ZDepth)),
            (None, None) => None,
        };
        Some(SceneFiles {
            rgb,
            range: path.map(|(file, kind)| RangeFile {
                file: file.as_str(),
                kind,
                unit_m: *unit_m,
                invalid_code: *invalid_code,
            }),
            instances: instances.as_deref(),
            intrinsics: None,
            classes: None,
            world_from_camera: None,
            hfov_deg: None,
            scale: None,
        })
    }
}
