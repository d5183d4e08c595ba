//! What a rendered frame consists of: files and the record.

use std::collections::BTreeMap;

use optics::water::RULES;
use serde_json::{Map, Value, json};
use spec::{ArtifactEntry, Camera, Counts, FrameRecord, Provenance};

use crate::provenance::{CODE_VERSION, cpu_features};
use crate::stage::enhance;
use crate::stage::files::{Files, Products};

/// A rendered frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The artifacts that the frame asks for.
    pub files: Vec<File>,
    /// Everything known about the image.
    pub record: FrameRecord,
}

/// A file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Artifact kind, such as `rgb`.
    pub kind: String,
    /// Such as `image/png`.
    pub media_type: &'static str,
    /// The file.
    pub bytes: Vec<u8>,
    /// SHA-256 of the bytes, lower-case hex.
    pub digest: String,
}

impl File {
    pub(crate) fn new(kind: String, media_type: &'static str, bytes: Vec<u8>) -> Self {
        let digest = spec::sha256(&bytes);
        Self {
            kind,
            media_type,
            bytes,
            digest,
        }
    }

    /// File name extension without the dot.
    #[must_use]
    pub fn extension(&self) -> &'static str {
        match self.media_type {
            "image/png" => "png",
            "image/webp" => "webp",
            "image/jpeg" => "jpg",
            "application/x-npy" => "npy",
            "application/json" => "json",
            _ => "bin",
        }
    }

    fn entry(&self) -> ArtifactEntry {
        ArtifactEntry {
            kind: self.kind.clone(),
            digest: self.digest.clone(),
            bytes: self.bytes.len() as u64,
            media_type: self.media_type.to_owned(),
        }
    }
}

/// Joins what a frame has gone through and its files.
pub(crate) fn finish(products: Products<'_>, files: Files, timings_ms: BTreeMap<String, f64>) -> Rendered {
    let warnings = warnings(&products, &files);
    let (prepared, styled) = (products.prepared, products.styled);
    let of_style = |(name, digest): &(String, String)| (format!("style.{name}"), digest.clone());
    let inputs = prepared
        .inputs
        .clone()
        .into_iter()
        .chain(styled.model.iter().map(of_style));
    let record = FrameRecord {
        frame: products.frame.index,
        parameters: parameters(&products),
        optics: numbers(&products),
        plan: json!(products.plan),
        artifacts: files.files.iter().map(File::entry).collect(),
        counts: Counts {
            holes: prepared.holes,
            negative_radiance: prepared.negative_radiance,
            clamped: products.clamped,
            range_saturated: files.range_saturated,
        },
        timings_ms,
        warnings,
        provenance: Provenance {
            code_version: CODE_VERSION.to_owned(),
            onnx_runtime: styled.runtime.clone(),
            cpu_features: cpu_features(),
            inputs: inputs.collect(),
        },
        measurements: products.measurements,
        scene: products.described,
    };
    Rendered {
        files: files.files,
        record,
    }
}

/// What the user should know about an image.
fn warnings(products: &Products<'_>, files: &Files) -> Vec<String> {
    let Products { frame, prepared, .. } = products;
    let Some(range) = &prepared.scene.range else {
        let skipped = [
            (frame.water.optics.is_some(), "water's optics are"),
            (frame.has_lamps(), "lamps are"),
            (frame.water.snow.is_some(), "snow is"),
        ];
        let skipped = skipped.into_iter().filter(|(asked, _)| *asked);
        let warnings = skipped.map(|(_, what)| format!("the scene has no range: the {what} skipped"));
        return warnings.chain(of_what_ran(products, files)).collect();
    };
    let is_empty = prepared.holes == range.data().len() as u64;
    let is_dark = products.setting.lighting.is_some() && !products.lit.shines && !products.glows;
    let diffuse = frame.water.optics.as_ref().and_then(RULES.warning);
    let exceeds = products.plan.exceeds.as_ref();
    let own = is_empty
        .then(|| "no pixel has a valid range".to_owned())
        .into_iter();
    own.chain(diffuse)
        .chain(is_dark.then(|| "no lamp lights anything in view".to_owned()))
        .chain(exceeds.map(|reason| format!("the plan exceeds the tolerance: {reason}")))
        .chain(of_what_ran(products, files))
        .collect()
}

/// Warnings of the enhancements and of the files.
fn of_what_ran(products: &Products<'_>, files: &Files) -> impl Iterator<Item = String> {
    enhance::warnings(products.enhanced).chain(files.warnings.iter().cloned())
}

/// The frame's resolved values, with the camera that took the picture.
fn parameters(products: &Products<'_>) -> Value {
    let mut parameters = products.frame.parameters.clone();
    if !matches!(products.frame.scene, spec::Scene::Procedural { .. }) {
        let (width, height) = products.setting.size;
        parameters["camera"] = json!(Camera::of_picture(width, height, products.prepared.focal_px));
    }
    parameters
}

/// The water's numbers by name, which of them were derived, the preset, and what was suspended in it; empty without water.
fn numbers(products: &Products<'_>) -> Map<String, Value> {
    let mut numbers = products.setting.water.as_ref().map_or_else(Map::new, of_water);
    if let Some([mean, least, most]) = products.lit.factors(products.prepared, products.setting) {
        numbers.insert(
            "turbidity".to_owned(),
            json!({"mean": mean, "least": least, "most": most}),
        );
    }
    if let Some(fallen) = products.fallen {
        numbers.insert("snow".to_owned(), fallen.describe());
    }
    numbers
}

fn of_water(water: &optics::water::Water) -> Map<String, Value> {
    let known = water
        .numbers()
        .into_iter()
        .filter_map(|(name, rgb)| Some((name.to_owned(), json!(rgb?))));
    let mut numbers: Map<String, Value> = known.collect();
    numbers.insert("derived".to_owned(), json!(water.derived()));
    numbers.insert(
        "backscatter_fraction".to_owned(),
        json!(water.backscatter_fraction()),
    );
    if let Some(preset) = water.preset() {
        numbers.insert("preset".to_owned(), json!(preset));
    }
    numbers
}
