//! The record of a frame before rendering; the stages add their results.

use optics::plan::{Plan, StageId};
use optics::water::{RULES, Water};
use serde_json::{Map, Value, json};
use spec::{Camera, Counts, FrameRecord, Provenance};

use crate::context::FrameContext;
use crate::provenance::{CODE_VERSION, cpu_features};

/// Starts the record of a frame.
pub(crate) fn begin(context: &FrameContext<'_>) -> FrameRecord {
    let FrameContext { frame, prepared, .. } = context;
    FrameRecord {
        frame: frame.index,
        parameters: parameters(context),
        optics: numbers(context),
        counts: Counts {
            holes: prepared.holes,
            negative_radiance: prepared.negative_radiance,
            ..Counts::default()
        },
        warnings: warnings(context),
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
fn parameters(context: &FrameContext<'_>) -> Value {
    let mut parameters = context.frame.parameters.clone();
    if !matches!(context.frame.scene, spec::Scene::Procedural { .. }) {
        let (width, height) = context.setting.size;
        let actual = json!(match context.prepared.hfov_deg {
            Some(hfov_deg) => Camera::pinhole(width, height, hfov_deg),
            None => Camera::from_focal(width, height, context.prepared.focal_px),
        });
        for (name, value) in actual.as_object().into_iter().flatten() {
            parameters["camera"][name] = value.clone();
        }
    }
    parameters
}

/// The coefficients of the water by name, the derived ones among them, its preset and its patches; empty without water.
fn numbers(context: &FrameContext<'_>) -> Map<String, Value> {
    let mut numbers = context
        .setting
        .water
        .as_ref()
        .map_or_else(Map::new, numbers_of_water);
    if let Some([mean, least, most]) = context.path_factors {
        let factors = json!({"mean": mean, "least": least, "most": most});
        numbers.insert("turbidity".to_owned(), factors);
    }
    let daylight = context.setting.water.as_ref().and_then(Water::daylight);
    if let (Some(daylight), Some(range)) = (daylight, &context.prepared.scene.range)
        && context.plan.stage(StageId::Surfaces).is_some()
        && let Some((shallowest, deepest)) = daylight.depths_m(range)
    {
        let mut own = json!({"shallowest_m": shallowest, "deepest_m": deepest});
        if let Some(pattern) = &context.pattern {
            own["caustics_peak"] = json!(pattern.tiles.peak());
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

/// Adds the plan, its bound, and a warning if the bound exceeds the tolerance.
pub(crate) fn finish_plan(record: &mut FrameRecord, plan: &Plan) {
    record.plan = json!(plan);
    record.promise = plan.promise();
    let exceeds = record
        .promise
        .as_ref()
        .and_then(|promise| promise.exceeds.as_ref());
    let warning = exceeds.map(|reason| format!("the plan exceeds the tolerance: {reason}"));
    record.warnings.extend(warning);
}

/// Adds new warnings from another moment of the frame.
pub(crate) fn merge_warnings(record: &mut FrameRecord, moment: FrameRecord) {
    for warning in moment.warnings {
        if !record.warnings.contains(&warning) {
            record.warnings.push(warning);
        }
    }
}

/// Warnings about the scene and its water.
fn warnings(context: &FrameContext<'_>) -> Vec<String> {
    let FrameContext { frame, prepared, .. } = context;
    let Some(range) = &prepared.scene.range else {
        let skipped = [
            (frame.water.optics.is_some(), "water's optics are"),
            (frame.has_lamps(), "lamps are"),
            (frame.water.snow.is_some(), "snow is"),
            (frame.water.sediment.is_some(), "sediment is"),
        ];
        let skipped = skipped.into_iter().filter(|(asked, _)| *asked);
        return skipped
            .map(|(_, part)| format!("the scene has no range: the {part} skipped"))
            .collect();
    };
    let is_empty = prepared.holes == range.data().len() as u64;
    let empty = is_empty.then(|| "no pixel has a valid range".to_owned());
    let diffuse = frame.water.optics.as_ref().and_then(RULES.warning);
    empty.into_iter().chain(diffuse).collect()
}
