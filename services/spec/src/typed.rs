//! From resolved JSON to a [`Frame`].

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::{Map, Value};

use crate::artifact::ArtifactKind;
use crate::frame::{Camera, Encode, Fidelity, Frame, Haze, Lamp, Scene, Water};

/// The resolved description as it stands in JSON.
#[derive(Deserialize)]
struct Resolved {
    dataset: String,
    seed: u64,
    scene: Scene,
    camera: Camera,
    water: Water,
    alpha: f64,
    lights: Vec<Light>,
    enhance: Vec<String>,
    metrics: Vec<String>,
    fidelity: WrittenFidelity,
    artifacts: Vec<String>,
    encode: Encode,
    labels: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Light {
    Haze(Haze),
    Point(Lamp),
    Spot(Lamp),
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum WrittenFidelity {
    Tolerance(f64),
    Terms(usize),
    Variant(Variant),
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Variant {
    Reference,
    Display,
}

/// The frame that a resolved description stands for; `count` is left out of its parameters.
///
/// # Errors
/// A description that the table of fields would refuse.
pub(crate) fn frame(index: u64, mut fields: Map<String, Value>) -> Result<Frame, serde_json::Error> {
    fields.remove("count");
    let parameters = Value::Object(fields);
    let mut resolved = Resolved::deserialize(&parameters)?;
    if let Scene::Files { range, .. } = &mut resolved.scene {
        range.take_if(|file| file.range.is_none() && file.z_depth.is_none());
    }
    let (mut lights, mut lamps) = (Vec::new(), Vec::new());
    for light in resolved.lights {
        match light {
            Light::Haze(haze) => lights.push(haze),
            Light::Point(lamp) | Light::Spot(lamp) => lamps.push(lamp),
        }
    }
    Ok(Frame {
        index,
        seed: resolved.seed,
        dataset: resolved.dataset,
        scene: resolved.scene,
        camera: resolved.camera,
        water: resolved.water,
        alpha: resolved.alpha,
        lights,
        lamps,
        enhance: resolved.enhance,
        metrics: resolved.metrics,
        fidelity: match resolved.fidelity {
            WrittenFidelity::Tolerance(tolerance) => Fidelity::Tolerance(tolerance),
            WrittenFidelity::Terms(terms) => Fidelity::Terms(terms),
            WrittenFidelity::Variant(Variant::Reference) => Fidelity::Reference,
            WrittenFidelity::Variant(Variant::Display) => Fidelity::Display,
        },
        artifacts: resolved
            .artifacts
            .iter()
            .filter_map(|name| ArtifactKind::parse(name))
            .collect(),
        encode: resolved.encode,
        labels: resolved.labels,
        parameters,
    })
}
