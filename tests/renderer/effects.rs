//! Effects that are rendered only if they change the picture.

use optics::plan::{Plan, StageId};
use renderer::{SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{engine_without_runtime, parse};

const EFFECTS: [StageId; 6] = [
    StageId::SunShadow,
    StageId::AmbientAccess,
    StageId::Caustics,
    StageId::Shafts,
    StageId::VeilOcclusion,
    StageId::Occlusion,
];

/// A structure by day.
fn job(water: &str, fidelity: &Value) -> Value {
    json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 192, "height": 124},
        "water": {"optics": water},
        "daylight": {"cloud_cover": 0.2},
        "fidelity": fidelity,
        "metrics": [],
    })
}

fn plan(job: &Value) -> Plan {
    let frame = parse(job).resolve(0).unwrap();
    let mut slot = Slot::new(&engine_without_runtime());
    slot.plan(&frame, &SceneSource::Local).unwrap()
}

fn running(plan: &Plan) -> usize {
    let runs = |id: &&StageId| !plan.variant(**id).is_skipped();
    EFFECTS.iter().filter(runs).count()
}

#[test]
fn a_plain_job_by_day_has_the_effects_that_it_shows() {
    let plan = plan(&job("jerlov-IB", &json!("picture")));
    assert!(running(&plan) >= 3, "{:?}", plan.stages);
    let stage = plan.stage(StageId::SunShadow).unwrap();
    let note = stage.note.as_deref().unwrap();
    assert!(
        note.starts_with("changes ") && note.contains("% of pixels"),
        "{note}"
    );
}

#[test]
fn what_the_water_hides_is_left_out_with_a_reason() {
    let mut murky = job("jerlov-9C", &json!("picture"));
    murky["water"]["range_scale"] = json!(8);
    let plan = plan(&murky);
    let left_out: Vec<_> = EFFECTS
        .iter()
        .filter_map(|id| plan.stage(*id))
        .filter(|stage| stage.variant.is_skipped())
        .collect();
    assert!(!left_out.is_empty(), "{:?}", plan.stages);
    for stage in left_out {
        let note = stage.note.as_deref().unwrap();
        assert!(
            note.starts_with("skipped, would change ") && note.contains(", saves "),
            "{note}"
        );
    }
    let promise = plan.promise().unwrap();
    assert!(!promise.unbounded.is_empty(), "{}", promise.text);
}

#[test]
fn a_budget_drops_effects_until_the_plan_fits() {
    let all = plan(&job("jerlov-IB", &json!("picture")));
    let whole = all.cost_ms().unwrap();
    let budget = 0.7 * whole;
    let fitted = plan(&job("jerlov-IB", &json!({"budget_ms": budget})));
    assert!(
        fitted.cost_ms().unwrap() <= budget,
        "{:?} of {whole}",
        fitted.cost_ms()
    );
    assert!(running(&fitted) <= running(&all));
    assert_eq!(fitted, plan(&job("jerlov-IB", &json!({"budget_ms": budget}))));
}

#[test]
fn a_budget_that_nothing_fits_is_a_warning() {
    let frame = parse(&job("jerlov-IB", &json!({"budget_ms": 0.01})))
        .resolve(0)
        .unwrap();
    let mut slot = Slot::new(&engine_without_runtime());
    let rendered = slot.render(&frame, &SceneSource::Local).unwrap();
    let warnings = rendered.record.warnings.join("\n");
    assert!(warnings.contains("`fidelity.budget_ms` is 0.01"), "{warnings}");
}

#[test]
fn a_tolerance_has_every_effect() {
    let plan = plan(&job("jerlov-9C", &json!({"tolerance": 1e-3})));
    assert_eq!(running(&plan), EFFECTS.len(), "{:?}", plan.stages);
}

#[test]
fn near_objects_occlude_scattered_light_where_it_shows() {
    let site = json!({"site": "pile-in-current", "camera": {"width": 192, "height": 123}, "seed": 1});
    let turbid = plan(&site);
    let stage = turbid.stage(StageId::Occlusion).unwrap();
    let note = stage.note.as_deref().unwrap();
    assert_eq!(stage.variant.name(), "gated", "{note}");
    assert!(
        note.starts_with("changes ") && note.contains("gates at "),
        "{note}"
    );
    let mut air = job("jerlov-IB", &json!("picture"));
    air["water"]["range_scale"] = json!(1e-3);
    let clear = plan(&air);
    let stage = clear.stage(StageId::Occlusion).unwrap();
    assert!(stage.variant.is_skipped(), "{stage:?}");
}

/// The bound of a frame with gates holds end to end.
#[test]
fn occlusion_agrees_with_the_reference() {
    let mut job = job("jerlov-3C", &json!({"tolerance": 1e-3}));
    job["camera"] = json!({"width": 48, "height": 31});
    job["daylight"] = json!("none");
    job["scene"]["lighting"] = json!("in_air");
    let render = |job: &Value| {
        let frame = parse(job).resolve(0).unwrap();
        let mut slot = Slot::new(&engine_without_runtime());
        slot.linear(&frame, &SceneSource::Local).unwrap()
    };
    let fast = render(&job);
    job["fidelity"] = json!("reference");
    let exact = render(&job);
    assert_eq!(fast.plan.variant(StageId::Occlusion).name(), "gated");
    let bound = fast.plan.promise().unwrap().bound;
    let pairs = fast.radiance.planes().iter().zip(exact.radiance.planes());
    let errors = pairs.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    let largest = errors
        .map(|(fast, exact)| (fast.min(1.0) - exact.min(1.0)).abs())
        .fold(0.0, f32::max);
    assert!(
        largest > 0.0 && f64::from(largest) <= bound,
        "{largest:e} of {bound:e}"
    );
}
