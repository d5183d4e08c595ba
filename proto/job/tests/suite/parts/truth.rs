//! Monte Carlo truth: accuracy, and fields that exclude it.

use serde_json::{Value, json};
use spec::Truth;

use crate::common::{document_with, errors, job_with, only_error};

/// A job of few pixels that requests its truth, with these fields.
fn traced(beside: Value) -> Value {
    let mut fields = json!({
        "camera": {"width": 64, "height": 48},
        "water": {"optics": {"absorption_per_m": [0.35, 0.08, 0.07], "scattering_per_m": [0.16, 0.18, 0.2],
                            "veiling_light": [0, 0, 0]}},
        "artifacts": ["truth", "truth_report"]
    });
    if let Value::Object(beside) = beside {
        for (name, value) in beside {
            fields[name] = value;
        }
    }
    fields
}

#[test]
fn absent_fields_are_their_defaults_and_change_no_job() {
    let frame = job_with(traced(json!({}))).resolve(0).unwrap();
    assert!(frame.is_traced());
    assert_eq!(frame.truth, None);
    assert!(frame.parameters.get("truth").is_none());
    let frame = job_with(traced(json!({"truth": {}}))).resolve(0).unwrap();
    assert_eq!(frame.truth, Some(Truth::default()));
    let plain = job_with(json!({}));
    assert!(!plain.resolve(0).unwrap().is_traced());
    assert!(!plain.canonical().contains("truth"));
}

#[test]
fn more_paths_than_the_limit_need_a_budget_that_pays_for_the_first() {
    let large = || json!({"camera": {"width": 300, "height": 300}});
    let error = only_error(traced(large()));
    assert_eq!(error.pointer, "/camera");
    assert!(
        error.message.contains("65536 paths for each of 90000 pixels"),
        "{}",
        error.message
    );
    let beside = |truth: Value| {
        let mut fields = large();
        fields["truth"] = truth;
        traced(fields)
    };
    assert_eq!(
        only_error(beside(json!({"paths_max": 131_072}))).pointer,
        "/truth/paths_max"
    );
    assert_eq!(
        only_error(beside(json!({"budget_s": 8}))).pointer,
        "/truth/budget_s"
    );
    job_with(beside(json!({"budget_s": 60})));
    job_with(beside(json!({"paths_max": 32_768})));
}

#[test]
fn all_untraced_fields_are_rejected_together() {
    let job = traced(json!({
        "scene": {"kind": "procedural", "family": "structure"},
        "camera": {"width": 64, "height": 48, "distortion": {"k1": -0.1}, "port": {"kind": "flat"}},
        "water": {
            "depth_m": 5, "holes": {"range_m": 9}, "sediment": {},
            "optics": {"absorption_per_m": [0.35, 0.08, 0.07], "scattering_per_m": [0.16, 0.18, 0.2],
                            "veiling_light": [0, 0, 0]}
        }
    }));
    let found: Vec<String> = errors(&document_with(job))
        .into_iter()
        .map(|error| error.pointer)
        .collect();
    for pointer in [
        "/camera/distortion",
        "/camera/port",
        "/water/holes/range_m",
        "/water/sediment",
    ] {
        assert!(
            found.iter().any(|at| at == pointer),
            "{pointer} is not in {found:?}"
        );
    }
}

#[test]
fn water_whose_scattering_is_not_known_has_no_truth() {
    let optics = json!({"beam_attenuation_per_m": [0.5, 0.3, 0.3], "veiling_light": [0.1, 0.2, 0.3]});
    let job = traced(json!({"water": {"optics": optics}}));
    let error = only_error(job);
    assert_eq!(error.pointer, "/water/optics");
    assert!(error.message.contains("nothing to trace"), "{}", error.message);
}

#[test]
fn the_accuracy_of_a_truth_needs_its_artifacts() {
    let error = only_error(json!({"truth": {"target": 0.1}}));
    assert_eq!(error.pointer, "/truth");
    assert!(error.message.contains("artifact `truth`"), "{}", error.message);
    job_with(traced(json!({"truth": {"target": 0.1}})));
}
