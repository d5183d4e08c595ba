//! One frame, fully resolved: plain values without distributions or open defaults.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value;
use spec_derive::Described;

use crate::artifact::ArtifactKind;
use crate::camera::Camera;
use crate::daylight::Daylight;
use crate::encode::Encode;
use crate::enhancement::Enhancement;
use crate::invalid::Invalid;
use crate::light::{Haze, Light, RaySource};
use crate::scene::Scene;
use crate::truth::Truth;
use crate::water::Water;

/// The site of a frame. A site written as a string expands its preset; in this form the description is already
/// complete.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Described)]
#[described(short = "name")]
pub struct SiteName {
    /// site name
    #[field(fixed, names = WaterName)]
    pub name: String,
}

/// One image of a job, with all distributions drawn.
///
/// `parameters` is the same description as canonical JSON (sorted keys, defaults filled in). The record stores it,
/// and the digest of a frame covers it.
#[derive(Debug, Clone, PartialEq, Deserialize, Described)]
pub struct Frame {
    /// Position in the job, from 0.
    #[serde(skip)]
    pub index: u64,
    /// dataset that the images join
    #[field(fixed, names = Dataset, default = "default")]
    pub dataset: String,
    /// seed of all distributions and of stage randomness
    #[field(fixed, within(0, u64::MAX), default = 0)]
    pub seed: u64,
    /// site that the description starts from, such as `shaft`; the other fields override the site's
    pub site: Option<SiteName>,
    /// the scene in air; required unless `site` has it
    #[field(optional)]
    pub scene: Scene,
    /// pinhole camera with a centered principal point, or a real camera
    #[field(default = {})]
    pub camera: Camera,
    /// water and its style
    #[field(default = {})]
    pub water: Water,
    /// share of the styled image
    #[field(within(0.0, 1.0), default = 1, needs("water.style"))]
    pub alpha: f64,
    /// sky above the water, `none` by night, or `auto`
    #[field(default = "auto")]
    pub daylight: Daylight,
    /// lamps in the water, and haze in drawing order
    #[field(max = 64, default = [])]
    pub lights: Vec<Light>,
    /// enhancements of the result, independent of each other
    #[field(max = 64, default = [])]
    pub enhance: Vec<Enhancement>,
    /// metrics to measure
    #[field(names = Metric, max = 64, distinct, default = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"])]
    pub metrics: Vec<String>,
    /// error bound against the reference: `picture` is one code of the 8-bit image or a third of the sensor noise,
    /// `reference` runs the slow f64 reference; or a number
    #[field(default = "picture")]
    pub fidelity: Fidelity,
    /// accuracy of the artifacts `truth` and `truth_report`
    #[field(fixed, needs("artifacts.truth", "artifacts.truth_report"))]
    pub truth: Option<Truth>,
    /// artifacts to store
    #[field(names = Artifact, max = 64, distinct, default = ["rgb"])]
    pub artifacts: Vec<ArtifactKind>,
    /// file format of RGB-like artifacts
    #[field(default = {})]
    pub encode: Encode,
    /// user-defined scalars, available to queries as `labels.<name>`
    #[field(fixed, default = {})]
    pub labels: BTreeMap<String, Value>,
    /// Canonical JSON of the fields above, without `index`.
    #[serde(skip)]
    pub parameters: Value,
    /// Distance of the camera to the right of its described position, m: the baseline for the right picture of a stereo
    /// pair, otherwise 0.
    #[serde(skip)]
    pub right_m: f64,
    /// Time of a frame of a stream, s; `None` for frames of jobs. All frames of a stream share one world, like those of a path.
    #[serde(skip)]
    pub stream_s: Option<f64>,
    /// The other frames of the path.
    #[serde(skip)]
    pub siblings: Siblings,
}

/// The frames of the same job. Frames are compared without them.
#[derive(Clone, Default)]
pub struct Siblings(Option<(u64, Arc<ResolveFrame>)>);

type ResolveFrame = dyn Fn(u64) -> Result<Frame, Invalid> + Send + Sync;

impl Siblings {
    /// The frames that `resolve` returns; `step` is the distance in the job of frames that follow each other on a path.
    pub(crate) fn new(
        step: u64,
        resolve: impl Fn(u64) -> Result<Frame, Invalid> + Send + Sync + 'static,
    ) -> Self {
        Self(Some((step, Arc::new(resolve))))
    }
}

impl PartialEq for Siblings {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl std::fmt::Debug for Siblings {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Siblings")
    }
}

impl Frame {
    /// Reads the frame from a resolved description; `count` is dropped from its parameters.
    ///
    /// # Errors
    /// A description outside the schema.
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

    /// The previous frame on the camera path; `None` for the first one and without a path. Like every frame, it does not
    /// depend on the number of frames of the job. If the description fixes the position on the path, the previous frame
    /// differs from this one only in its position and index.
    ///
    /// # Errors
    /// As [`crate::Job::resolve`].
    pub fn previous(&self) -> Result<Option<Self>, Invalid> {
        self.neighbor(-1)
    }

    /// The next frame on the camera path, as [`Frame::previous`]; `None` for the last one of the path.
    ///
    /// # Errors
    /// As [`crate::Job::resolve`].
    pub fn next(&self) -> Result<Option<Self>, Invalid> {
        self.neighbor(1)
    }

    fn neighbor(&self, direction: i64) -> Result<Option<Self>, Invalid> {
        let Some(mut path) = self.camera.path else {
            return Ok(None);
        };
        let position = path.frame as i64 + direction;
        if !(0..path.frames as i64).contains(&position) {
            return Ok(None);
        }
        path.frame = position as usize;
        let Siblings(Some((step, resolve))) = &self.siblings else {
            let mut moved = self.clone();
            moved.index = self.index.wrapping_add_signed(direction);
            moved.camera.path = Some(path);
            moved.parameters["camera"]["path"]["frame"] = position.into();
            return Ok(Some(moved));
        };
        let steps = direction * *step as i64;
        let neighbor = resolve(self.index.wrapping_add_signed(steps))?;
        // Frames with a path drawn for each of them have no neighbors.
        let is_next = neighbor.camera.path == Some(path) && neighbor.scene == self.scene;
        Ok(is_next.then_some(neighbor))
    }

    /// The haze in drawing order.
    #[must_use]
    pub fn haze(&self) -> Vec<Haze> {
        self.lights
            .iter()
            .filter_map(|light: &Light| match light {
                Light::Haze(haze) => Some(*haze),
                Light::Point(_) | Light::Spot(_) => None,
            })
            .collect()
    }

    /// Number of lamps in the water.
    #[must_use]
    pub fn lamp_count(&self) -> usize {
        self.lights
            .iter()
            .filter(|light: &&Light| !matches!(light, Light::Haze(_)))
            .count()
    }

    /// Whether lamps light the water.
    #[must_use]
    pub fn has_lamps(&self) -> bool {
        self.lamp_count() > 0
    }

    /// Where shadow rays look for occluders.
    #[must_use]
    pub fn ray_source(&self) -> RaySource {
        match self.scene {
            Scene::Procedural { .. } => RaySource::Scene,
            _ => RaySource::Screen,
        }
    }

    /// Whether an artifact needs the Monte Carlo light.
    #[must_use]
    pub fn is_traced(&self) -> bool {
        self.artifacts.iter().any(ArtifactKind::is_traced)
    }

    /// Index of the world that particles and patches are drawn from. All frames of a path or of a stream share one;
    /// otherwise each frame has its own.
    #[must_use]
    pub fn world_index(&self) -> u64 {
        let is_shared = self.camera.path.is_some() || self.stream_s.is_some();
        if is_shared { 0 } else { self.index }
    }
}

/// Error bound against the reference.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// One code of the 8-bit image, or a third of the sensor noise.
    Picture,
    /// The slow f64 reference.
    Reference,
    /// maximum error in linear light
    #[field(within(1e-7, 1.0))]
    Tolerance(f64),
    /// kernels of the fast forward scatter
    #[field(within(1, 64))]
    Terms(usize),
    /// expected milliseconds on one core; selects the effects and tolerance with the least expected error within it
    #[field(above(0.0, 1e6), unit = "ms")]
    BudgetMs(f64),
}
