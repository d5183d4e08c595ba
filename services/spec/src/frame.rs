//! One frame, fully resolved: plain values, no law, no default left open.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;
use spec_derive::Described;

use crate::artifact::ArtifactKind;
use crate::camera::Camera;
use crate::daylight::Daylight;
use crate::encode::Encode;
use crate::inhabited::{Ground, Life};
use crate::light::{Haze, Light, RaySource};
use crate::scene_files::{RangeFile, RangeKind, SceneFiles};
use crate::schema::EXACT;
use crate::truth::Truth;
use crate::water::Water;

/// The site of a frame. A job that names one as a string starts from its preset; in this form the job or frame is
/// already complete.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Described)]
#[described(short = "name")]
pub struct SiteName {
    /// name of the site
    #[field(fixed, names = WaterName)]
    pub name: String,
}

/// One image of a job, with every law replaced by its value.
///
/// `parameters` is the same description as canonical JSON (sorted keys, defaults filled in): it is what the record
/// stores and what the digest of a job covers.
#[derive(Debug, Clone, PartialEq, Deserialize, Described)]
pub struct Frame {
    /// Position in the job, `0..frames`.
    #[serde(skip)]
    pub index: u64,
    /// the collection the images join
    #[field(fixed, names = Dataset, default = "default")]
    pub dataset: String,
    /// seed of all laws and of stage randomness
    #[field(fixed, within(0, u64::MAX), default = 0)]
    pub seed: u64,
    /// the place that the description starts from, such as `shaft`: every field beside it replaces the site's
    pub site: Option<SiteName>,
    /// what the camera would see in air; required unless `site` has it
    #[field(optional)]
    pub scene: Scene,
    /// pinhole camera, principal point in the middle, or a real one
    #[field(default = {})]
    pub camera: Camera,
    /// the water and its style
    #[field(default = {})]
    pub water: Water,
    /// share of the styled image
    #[field(within(0.0, 1.0), default = 1, needs("water.style"))]
    pub alpha: f64,
    /// the sky above the water, `none` by night, or `auto`
    #[field(default = "auto")]
    pub daylight: Daylight,
    /// lamps in the water, and haze in drawing order
    #[field(max = 64, default = [])]
    pub lights: Vec<Light>,
    /// enhancement methods to run on the result
    #[field(names = Enhancement, max = 64, distinct, default = [])]
    pub enhance: Vec<String>,
    /// metrics to measure
    #[field(names = Metric, max = 64, distinct, default = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"])]
    pub metrics: Vec<String>,
    /// how close to the reference the picture must be: `picture`, within one code of the 8-bit picture or a third of the noise of the
    /// sensor; `reference`, the slow f64 reference; or a number
    #[field(default = "picture")]
    pub fidelity: Fidelity,
    /// how well the artifacts `truth` and `truth_report` must know the light
    #[field(fixed, needs("artifacts.truth", "artifacts.truth_report"))]
    pub truth: Option<Truth>,
    /// what to store
    #[field(names = Artifact, max = 64, distinct, default = ["rgb"])]
    pub artifacts: Vec<ArtifactKind>,
    /// file format of RGB-like artifacts
    #[field(default = {})]
    pub encode: Encode,
    /// the user's own scalars, queryable as `labels.<name>`
    #[field(fixed, default = {})]
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

    /// Where its shadow rays look for occluders.
    #[must_use]
    pub fn ray_source(&self) -> RaySource {
        match self.scene {
            Scene::Procedural { .. } => RaySource::Scene,
            _ => RaySource::Screen,
        }
    }

    /// Whether an artifact asks for its light by Monte Carlo.
    #[must_use]
    pub fn is_traced(&self) -> bool {
        self.artifacts.iter().any(ArtifactKind::is_traced)
    }

    /// Which of the worlds of its seed its particles and patches come from: all frames of a path share their water, any
    /// other has its own.
    #[must_use]
    pub fn world_index(&self) -> u64 {
        if self.camera.path.is_some() { 0 } else { self.index }
    }
}

/// Where radiance and range come from.
#[derive(Debug, Clone, PartialEq, Deserialize, Described)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Scene {
    /// Rendered from a seed.
    Procedural {
        /// family of scenes
        #[field(names = Family)]
        family: String,
        /// seed of the scene, apart from the job's seed
        #[field(within(0, EXACT), default = 0)]
        seed: u64,
        /// what lights its surfaces
        #[field(default = "water")]
        lighting: SceneLighting,
        /// what lives on and about it, and what hangs there; nothing by default
        life: Option<Life>,
        /// what current and grain make of its bottom; an even one by default
        ground: Option<Ground>,
    },
    /// Uploaded before through the API.
    Uploaded {
        /// an uploaded scene, which brings its own size
        #[field(names = SceneId)]
        id: String,
        /// what lights its surfaces
        #[field(default = "in_air")]
        lighting: SceneLighting,
    },
    /// Files of this machine; only for rendering without a service.
    Files {
        /// PNG, JPEG, WebP, NPY or EXR picture
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
        /// JSON that says what the instances are
        #[field(names = Path, needs("instances"))]
        classes: Option<String>,
        /// meters of one unit of the range file
        #[field(above(0.0, 1e6), unit = "m", needs("range", "z_depth"))]
        unit_m: Option<f64>,
        /// code that means no return in the range file
        #[field(within(0, 65_535), needs("range", "z_depth"))]
        invalid_code: Option<u16>,
        /// what lights its surfaces
        #[field(default = "in_air")]
        lighting: SceneLighting,
    },
    /// A collection of uploaded scenes.
    Collection {
        /// a collection of uploaded scenes
        #[field(fixed, names = Collection)]
        name: String,
        /// whether each frame takes the next scene, with as many frames of each as `count` says; else every frame takes one by
        /// chance
        #[field(fixed, default = true)]
        each: bool,
        /// its scenes when the job was accepted; filled in
        #[field(names = SceneId)]
        id: Option<String>,
        /// what lights its surfaces
        #[field(default = "in_air")]
        lighting: SceneLighting,
    },
}

/// What lights the surfaces of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum SceneLighting {
    /// The picture contains its illumination, as a photograph in air does.
    InAir,
    /// The picture is reflectance, lit by the daylight and the lamps in the water.
    Water,
}

impl Scene {
    /// What lights its surfaces.
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

    /// The paths of a scene of files; its classes are read apart.
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
        })
    }
}

/// How close to the reference the picture must be.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// Within one code of the 8-bit picture, or a third of the noise of the sensor.
    Picture,
    /// The slow f64 reference.
    Reference,
    /// largest error in linear light
    #[field(within(1e-7, 1.0))]
    Tolerance(f64),
    /// kernels of the fast forward scatter
    #[field(within(1, 64))]
    Terms(usize),
    /// expected milliseconds of one core: the effects and the tolerance with the least expected distance from the reference that fit
    #[field(above(0.0, 1e6), unit = "ms")]
    BudgetMs(f64),
}
