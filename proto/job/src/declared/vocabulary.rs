use std::collections::BTreeMap;

use serde_json::{Map, Value};

use crate::artifact::ArtifactKind;
use crate::enhancement::{METHODS, NETWORK_METHOD};
use crate::rules::{CameraRules, WaterRules};
use crate::schema::Names;

/// The names that a description may use, provided by the crates and folders that define them.
#[derive(Debug, Clone, Default)]
pub struct Vocabulary {
    /// Families of procedural scenes.
    pub families: Vec<String>,
    /// Full names of the water presets (`jerlov-3C/williamson2022`). The part before the slash abbreviates the first
    /// preset with it (`jerlov-3C`).
    pub presets: Vec<String>,
    /// Presets that cannot be rendered, with the reason.
    pub unrenderable_presets: Vec<(String, String)>,
    /// User-defined waters: fields of `water.optics` by name.
    pub waters: BTreeMap<String, Map<String, Value>>,
    /// Consistency rules of waters.
    pub rules: WaterRules,
    /// Camera presets.
    pub cameras: Vec<String>,
    /// Sensor presets.
    pub sensors: Vec<String>,
    /// Consistency rules of cameras.
    pub camera_rules: CameraRules,
    /// Style models.
    pub styles: Vec<String>,
    /// Style models that use the range of each pixel.
    pub range_styles: Vec<String>,
    /// Networks of the user that enhance a picture.
    pub enhancers: Vec<KnownNetwork>,
    /// Networks of the user that measure a picture: the metrics `net.NAME`.
    pub metric_networks: Vec<KnownNetwork>,
    /// Metrics, `name` or `name@profile`.
    pub metrics: Vec<String>,
    /// Metrics that compare with the previous frames of a camera path.
    pub path_metrics: Vec<String>,
    /// Collections of uploaded scenes: the ids of their scenes in order. Only collections mentioned by the
    /// description need to be present.
    pub collections: BTreeMap<String, Vec<String>>,
    /// Whether `scene.kind` may be `files`.
    pub local: bool,
}

/// Prefix of the metrics that a network of the user computes.
pub const METRIC_NETWORK: &str = "net.";

/// A network of the user that enhances or measures a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KnownNetwork {
    /// Its name.
    pub name: String,
    /// SHA-256 of its file, lower-case hex.
    pub digest: String,
    /// The only picture size, columns and rows; `None` for networks of several sizes.
    pub size: Option<[usize; 2]>,
}

impl KnownNetwork {
    /// Whether its file has this digest. That of an imported job's network is unknown, and its digest empty.
    fn has_digest(&self, written: &str) -> bool {
        !self.digest.is_empty() && self.digest == written
    }
}

impl Vocabulary {
    /// The allowed names; empty if any well-formed text is allowed.
    #[must_use]
    pub fn listed(&self, names: Names) -> Vec<String> {
        match names {
            Names::Fixed(list) => list.iter().map(|name| (*name).to_owned()).collect(),
            Names::Family => self.families.clone(),
            Names::Preset => self.presets.iter().chain(self.waters.keys()).cloned().collect(),
            Names::Camera => self.cameras.clone(),
            Names::Sensor => self.sensors.clone(),
            Names::Style => self.styles.clone(),
            Names::Method => METHODS.iter().map(|name| (*name).to_owned()).collect(),
            Names::Enhancer => self
                .enhancers
                .iter()
                .map(|network| network.name.clone())
                .collect(),
            Names::Metric => {
                let networks = self.metric_networks.iter();
                let networks = networks.map(|network| format!("{METRIC_NETWORK}{}", network.name));
                self.metrics.iter().cloned().chain(networks).collect()
            }
            Names::Artifact => self.artifacts().iter().map(ToString::to_string).collect(),
            Names::Enhancement
            | Names::Words
            | Names::WaterName
            | Names::Dataset
            | Names::Collection
            | Names::SceneId
            | Names::Path
            | Names::MaskImage => Vec::new(),
        }
    }

    /// Every kind of artifact: the fixed ones, then the result of each method.
    #[must_use]
    pub fn artifacts(&self) -> Vec<ArtifactKind> {
        let fixed = ArtifactKind::FIXED.iter().map(|(_, kind)| kind.clone());
        let enhanced = METHODS
            .iter()
            .map(|name| ArtifactKind::Enhanced((*name).to_owned()));
        fixed.chain(enhanced).collect()
    }

    /// The name of the enhancer with this name or digest.
    pub(crate) fn enhancer(&self, written: &str) -> Option<&str> {
        let networks = &self.enhancers;
        let by_name = networks.iter().find(|network| network.name == written);
        let found = by_name.or_else(|| networks.iter().find(|network| network.has_digest(written)));
        found.map(|network| network.name.as_str())
    }

    /// How to use a model whose role does not fit the field that names it.
    pub(crate) fn usage_of_model(&self, written: &str) -> Option<String> {
        let name = written.strip_prefix(METRIC_NETWORK).unwrap_or(written);
        if self.styles.iter().any(|style| style == name) {
            return Some(format!("is a style; use it as `water.style`: \"{name}\""));
        }
        if let Some(name) = self.enhancer(name) {
            return Some(format!(
                "is an enhancer; use it in `enhance`: {{\"method\": \"{NETWORK_METHOD}\", \"model\": \"{name}\"}}"
            ));
        }
        let mut metrics = self.metric_networks.iter();
        let metric = metrics.find(|network| network.name == name || network.has_digest(name))?;
        let name = &metric.name;
        Some(format!(
            "is a metric; use it in `metrics`: \"{METRIC_NETWORK}{name}\""
        ))
    }

    /// The full name of a preset with this full or short name.
    pub(crate) fn preset(&self, written: &str) -> Option<&str> {
        self.presets
            .iter()
            .find(|full: &&String| *full == written || full.split('/').next() == Some(written))
            .map(String::as_str)
    }

    /// Why a preset, by its full name, cannot be rendered.
    pub(crate) fn why_unrenderable(&self, full: &str) -> Option<&str> {
        let found = self.unrenderable_presets.iter().find(|(name, _)| name == full);
        found.map(|(_, why)| why.as_str())
    }
}
