//! What a rendered frame consists of: files and the record.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};
use spec::{ArtifactEntry, Counts, FrameRecord, Provenance, SceneRecord};

use crate::provenance::{CODE_VERSION, cpu_features};
use crate::stage::measure::Measurements;
use crate::stage::snow::Fallen;
use crate::stage::water::Chosen;

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

/// What the record is made of, beside what the frame and the files say.
pub(crate) struct Findings<'a> {
    pub(crate) frame: &'a spec::Frame,
    /// The camera of the picture, which for an uploaded scene is not the one of the frame.
    pub(crate) camera: spec::Camera,
    pub(crate) chosen: &'a Chosen,
    /// Mean, least and greatest path through patches as a share of the range.
    pub(crate) factors: Option<[f64; 3]>,
    pub(crate) fallen: Option<&'a Fallen>,
    pub(crate) measurements: Measurements,
    pub(crate) counts: Counts,
    pub(crate) timings_ms: BTreeMap<String, f64>,
    pub(crate) warnings: Vec<String>,
    pub(crate) inputs: BTreeMap<String, String>,
    pub(crate) onnx_runtime: Option<String>,
    pub(crate) scene: Option<SceneRecord>,
}

/// Joins files and findings.
pub(crate) fn finish(files: Vec<File>, findings: Findings<'_>) -> Rendered {
    let record = FrameRecord {
        frame: findings.frame.index,
        parameters: parameters(&findings),
        optics: numbers(&findings),
        plan: plan(findings.frame, findings.chosen, findings.fallen),
        measurements: findings.measurements,
        artifacts: files.iter().map(File::entry).collect(),
        counts: findings.counts,
        timings_ms: findings.timings_ms,
        warnings: findings.warnings,
        scene: findings.scene,
        provenance: Provenance {
            code_version: CODE_VERSION.to_owned(),
            onnx_runtime: findings.onnx_runtime,
            cpu_features: cpu_features(),
            inputs: findings.inputs,
        },
    };
    Rendered { files, record }
}

/// The frame's resolved values, with the camera that took the picture.
fn parameters(findings: &Findings<'_>) -> Value {
    let mut parameters = findings.frame.parameters.clone();
    if !matches!(findings.frame.scene, spec::Scene::Procedural { .. }) {
        parameters["camera"] = json!(findings.camera);
    }
    parameters
}

/// The water's numbers by name, which of them were derived, the preset, and what was suspended in it; empty without water.
fn numbers(findings: &Findings<'_>) -> Map<String, Value> {
    let mut numbers = findings.chosen.water.as_ref().map_or_else(Map::new, of_water);
    if let Some([mean, least, most]) = findings.factors {
        numbers.insert(
            "turbidity".to_owned(),
            json!({"mean": mean, "least": least, "most": most}),
        );
    }
    if let Some(fallen) = findings.fallen {
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

/// The plan as a list of stages; what is not known of a stage is left out.
pub(crate) fn plan(frame: &spec::Frame, chosen: &Chosen, fallen: Option<&Fallen>) -> Value {
    let in_water = |stage: &str| stage.starts_with("attenuation") || stage.starts_with("forward_scatter");
    let suspended = suspended(frame, chosen, fallen);
    let notes = chosen.plan.describe().into_iter().flat_map(|note| {
        let before = (note.stage == "style").then(|| suspended.clone());
        let skipped = chosen.water.is_none() && in_water(note.stage);
        let mut entry = Map::new();
        entry.insert("stage".to_owned(), json!(note.stage));
        entry.insert(
            "variant".to_owned(),
            json!(if skipped { "skip" } else { note.variant }),
        );
        if let Some(terms) = note.terms {
            entry.insert("terms".to_owned(), json!(terms));
        }
        if let Some(bound) = note.bound {
            // What goes into the water with an error comes out with one.
            entry.insert("bound".to_owned(), json!(bound + chosen.shares.rounding));
        }
        before.into_iter().flatten().chain([Value::Object(entry)])
    });
    notes.collect()
}

/// The lines of turbidity, lamps and snow. What turbidity rounds is part of the bounds of the water.
fn suspended(frame: &spec::Frame, chosen: &Chosen, fallen: Option<&Fallen>) -> Vec<Value> {
    let reference = frame.fidelity == spec::Fidelity::REFERENCE;
    let either = |fast: &'static str| if reference { "reference" } else { fast };
    let line = |stage: &str, variant: &str, bound: f64| {
        let mut line = json!({"stage": stage, "variant": variant});
        if bound > 0.0 && !reference && variant != "skip" {
            line["bound"] = json!(bound);
        }
        line
    };
    let patchy = chosen.patches.is_some();
    let turbidity = if patchy { either("closed_form") } else { "skip" };
    let lamps = if frame.has_lamps() {
        either("quadrature")
    } else {
        "skip"
    };
    let planned = if frame.water.snow.is_some() {
        either("discs")
    } else {
        "skip"
    };
    let snow = fallen.map_or(planned, |fallen| fallen.variant);
    let of_snow = json!({"stage": "snow", "variant": snow, "bound": chosen.shares.snow});
    vec![
        line("turbidity", turbidity, 0.0),
        line("lamps", lamps, chosen.shares.lamps),
        // Where it is skipped, the share bounds what is expected to be lost.
        if snow == "skip" && fallen.is_some() {
            of_snow
        } else {
            line("snow", snow, chosen.shares.snow)
        },
    ]
}
