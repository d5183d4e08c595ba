//! One frame, fully resolved: plain values, no law, no default left open.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::artifact::ArtifactKind;
use crate::camera::Camera;
use crate::light::{Haze, Light};
use crate::scene_files::{RangeFile, RangeKind, SceneFiles};
use crate::water::Water;

/// One image of a job, with every law replaced by its value.
///
/// `parameters` is the same description as canonical JSON (sorted keys, defaults filled in): it is what the record
/// stores and what the digest of a job covers.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Frame {
    /// Position in the job, `0..frames`.
    #[serde(skip)]
    pub index: u64,
    /// the collection the images join
    pub dataset: String,
    /// seed of all laws and of stage randomness
    pub seed: u64,
    /// what the camera would see in air
    pub scene: Scene,
    /// pinhole camera, principal point in the middle
    pub camera: Camera,
    /// the water and its style
    pub water: Water,
    /// share of the styled image
    pub alpha: f64,
    /// lamps in the water, and haze in drawing order
    pub lights: Vec<Light>,
    /// enhancement methods to run on the result
    pub enhance: Vec<String>,
    /// metrics to measure
    pub metrics: Vec<String>,
    /// how exact the water must be
    pub fidelity: Fidelity,
    /// what to store
    pub artifacts: Vec<ArtifactKind>,
    /// file format of RGB-like artifacts
    pub encode: Encode,
    /// the user's own scalars, queryable as `labels.<name>`
    pub labels: BTreeMap<String, Value>,
    /// The canonical JSON of all of the above, without `index`.
    #[serde(skip)]
    pub parameters: Value,
}

impl Frame {
    /// The frame that a resolved description stands for; `count` is left out of its parameters.
    ///
    /// # Errors
    /// A description that the table of fields would refuse.
    pub(crate) fn read(index: u64, mut parameters: Value) -> Result<Self, serde_json::Error> {
        if let Value::Object(fields) = &mut parameters {
            fields.remove("count");
        }
        let frame = Self::deserialize(&parameters)?;
        Ok(Self {
            index,
            parameters,
            ..frame
        })
    }

    /// Its haze, in the order in which it is laid over the picture.
    #[must_use]
    pub fn haze(&self) -> Vec<Haze> {
        let haze = |light: &Light| match light {
            Light::Haze(haze) => Some(*haze),
            Light::Point(_) | Light::Spot(_) => None,
        };
        self.lights.iter().filter_map(haze).collect()
    }

    /// Number of lamps in the water.
    #[must_use]
    pub fn lamp_count(&self) -> usize {
        let is_lamp = |light: &&Light| !matches!(light, Light::Haze(_));
        self.lights.iter().filter(is_lamp).count()
    }

    /// Whether lamps light the water.
    #[must_use]
    pub fn has_lamps(&self) -> bool {
        self.lamp_count() > 0
    }

    /// Which of the worlds of its seed its particles and patches come from: all frames of a path share their water, any
    /// other has its own.
    #[must_use]
    pub fn world_index(&self) -> u64 {
        if self.camera.path.is_some() { 0 } else { self.index }
    }
}

/// Where radiance and range come from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Scene {
    /// Rendered from a seed.
    Procedural {
        /// family of scenes
        family: String,
        /// seed of the scene, apart from the job's seed
        seed: u64,
    },
    /// Uploaded before through the API.
    Uploaded {
        /// an uploaded scene, which brings its own size
        id: String,
    },
    /// Files of this machine; only for rendering without a service.
    Files {
        /// PNG, JPEG, WebP or NPY picture
        rgb: String,
        /// distances along the line of sight
        range: Option<String>,
        /// distances along the optical axis, instead of `range`
        z_depth: Option<String>,
        /// metres of one unit of that file
        unit_m: Option<f64>,
        /// code that means no return in that file
        invalid_code: Option<u16>,
    },
}

impl Scene {
    /// The paths of a scene of files.
    #[must_use]
    pub fn files(&self) -> Option<SceneFiles<&str>> {
        let Self::Files {
            rgb,
            range,
            z_depth,
            unit_m,
            invalid_code,
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
            instances: None,
            intrinsics: None,
        })
    }
}

/// How exact the water must be.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// largest error in linear light
    Tolerance(f64),
    /// kernels of the fast forward scatter
    Terms(usize),
    /// `reference`, the slow f64 form, or `display`, within one code of the 8-bit picture
    Variant(Variant),
}

/// A fidelity with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The slow f64 form.
    Reference,
    /// One code of the 8-bit picture.
    Display,
}

impl Fidelity {
    /// The slow f64 form.
    pub const REFERENCE: Self = Self::Variant(Variant::Reference);
    /// One code of the 8-bit picture.
    pub const DISPLAY: Self = Self::Variant(Variant::Display);
}

/// How RGB-like artifacts are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(tag = "format", rename_all = "snake_case")]
pub enum Encode {
    /// PNG, lossless.
    Png,
    /// WebP, lossless.
    Webp,
    /// JPEG.
    Jpeg {
        /// JPEG quality
        quality: u8,
    },
}
