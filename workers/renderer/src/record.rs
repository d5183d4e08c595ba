//! The record of a frame as known before rendering; the stages add their results.

use optics::water::{RULES, Water};
use serde_json::{Map, Value, json};
use spec::{Camera, Counts, FrameRecord, Provenance};

use crate::provenance::{CODE_VERSION, cpu_features};
use crate::stage::Shot;

/// Starts the record of a frame.
pub(crate) fn begin(shot: &Shot<'_>) -> FrameRecord {
    let Shot { frame, prepared, .. } = shot;
    FrameRecord {
        frame: frame.index,
        parameters: parameters(shot),
        optics: numbers(shot),
        plan: json!(shot.frame_plan()),
        counts: Counts {
            holes: prepared.holes,
            negative_radiance: prepared.negative_radiance,
            ..Counts::default()
        },
        warnings: warnings(shot),
        provenance: Provenance {
            code_version: CODE_VERSION.to_owned(),
            onnx_runtime: None,
            cpu_features: cpu_features(),
            inputs: prepared.inputs.clone(),
        },
        ..FrameRecord::default()
    }
}

/// The frame's resolved parameters, with the actual camera.
fn parameters(shot: &Shot<'_>) -> Value {
    let mut parameters = shot.frame.parameters.clone();
    if !matches!(shot.frame.scene, spec::Scene::Procedural { .. }) {
        let (width, height) = shot.setting.size;
        let actual = json!(Camera::of_picture(width, height, shot.prepared.focal_px));
        for (name, value) in actual.as_object().into_iter().flatten() {
            parameters["camera"][name] = value.clone();
        }
    }
    parameters
}

/// The coefficients of the water by name, which of them were derived, its preset and its patches; empty without water.
fn numbers(shot: &Shot<'_>) -> Map<String, Value> {
    let mut numbers = shot
        .setting
        .water
        .as_ref()
        .map_or_else(Map::new, numbers_of_water);
    if let Some([mean, least, most]) = shot.lit.factors() {
        let factors = json!({"mean": mean, "least": least, "most": most});
        numbers.insert("turbidity".to_owned(), factors);
    }
    let daylight = shot.setting.water.as_ref().and_then(Water::daylight);
    if let (Some(daylight), Some(range)) = (daylight, &shot.prepared.scene.range)
        && shot.lit.above.is_some()
        && let Some((shallowest, deepest)) = daylight.depths_m(range)
    {
        let mut own = json!({"shallowest_m": shallowest, "deepest_m": deepest});
        if let Some(pattern) = &shot.lit.pattern {
            own["caustics_peak"] = json!(pattern.peak());
        }
        numbers.insert("daylight".to_owned(), own);
    }
    numbers
}

fn numbers_of_water(water: &Water) -> Map<String, Value> {
    let known = water.numbers().into_iter();
    let known = known.filter_map(|(name, rgb)| Some((name, json!(rgb?))));
    let rest = [
        ("derived", json!(water.derived())),
        ("backscatter_fraction", json!(water.backscatter_fraction())),
    ];
    let preset = water.preset().map(|preset| ("preset", json!(preset)));
    let numbers = known.chain(rest).chain(preset);
    numbers.map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Warnings about the scene, its water and its plan.
fn warnings(shot: &Shot<'_>) -> Vec<String> {
    let Shot {
        frame,
        prepared,
        plan,
        ..
    } = shot;
    let Some(range) = &prepared.scene.range else {
        let skipped = [
            (frame.water.optics.is_some(), "water's optics are"),
            (frame.has_lamps(), "lamps are"),
            (frame.water.snow.is_some(), "snow is"),
        ];
        let skipped = skipped.into_iter().filter(|(asked, _)| *asked);
        return skipped
            .map(|(_, what)| format!("the scene has no range: the {what} skipped"))
            .collect();
    };
    let is_empty = prepared.holes == range.data().len() as u64;
    let empty = is_empty.then(|| "no pixel has a valid range".to_owned());
    let diffuse = frame.water.optics.as_ref().and_then(RULES.warning);
    let exceeds = plan.exceeds.as_ref();
    let exceeds = exceeds.map(|reason| format!("the plan exceeds the tolerance: {reason}"));
    empty.into_iter().chain(diffuse).chain(exceeds).collect()
}
