//! Rejected snow and turbidity.

use serde_json::json;

use crate::common::{document_with, errors, job_with, only_error};

#[test]
fn a_mask_of_snow_needs_snow() {
    let error = only_error(json!({"artifacts": ["rgb", "snow_mask"]}));
    assert_eq!(error.pointer, "/artifacts/1");
    assert_eq!(
        error.message,
        "the artifact \"snow_mask\" needs `water.snow` or `water.sediment`: add it, or remove the artifact"
    );
}

fn snow(fields: serde_json::Value) -> serde_json::Value {
    json!({"water": {"snow": fields}})
}

#[test]
fn all_errors_of_snow_are_reported() {
    let pointers = |more| {
        errors(&document_with(more))
            .into_iter()
            .map(|error| error.pointer)
            .collect::<Vec<_>>()
    };
    let wrong = json!({"density_per_m3": -1, "radius_m": 1, "spectrum": 9, "near_m": 0, "far_m": 1e3, "albedo": [2, 0, 0]});
    let mut found = pointers(snow(wrong));
    found.sort_unstable();
    let expected = [
        "albedo/0",
        "density_per_m3",
        "far_m",
        "near_m",
        "radius_m",
        "spectrum",
    ];
    assert_eq!(found, expected.map(|field| format!("/water/snow/{field}")));
    assert_eq!(pointers(snow(json!({}))), ["/water/snow/density_per_m3"]);
    let turned = json!({"density_per_m3": 1, "near_m": {"uniform": [0.1, 5]}});
    assert_eq!(pointers(snow(turned)), ["/water/snow/near_m"]);
    let thick = only_error(snow(json!({"density_per_m3": 1e5, "radius_m": 0.01})));
    assert!(
        thick.message.contains("cover the whole frame"),
        "{}",
        thick.message
    );
    let many = json!({"density_per_m3": {"uniform": [1, 1e5]}, "radius_m": 1e-5, "far_m": 30});
    let many = only_error(snow(many));
    assert_eq!(many.pointer, "/water/snow/density_per_m3");
    assert!(many.message.contains("in this view"), "{}", many.message);
    let patchy = json!({"water": {"optics": "jerlov-1C", "turbidity": {"contrast": 1, "scale_m": 0}}});
    assert_eq!(
        pointers(patchy),
        ["/water/turbidity/contrast", "/water/turbidity/scale_m"]
    );
}

#[test]
fn aggregates_and_drift_have_limits() {
    let wrong = json!({"density_per_m3": 1, "aggregates": 2, "drift_m_per_s": [9, 0, 0]});
    let mut found: Vec<_> = errors(&document_with(snow(wrong)))
        .into_iter()
        .map(|error| error.pointer)
        .collect();
    found.sort_unstable();
    let expected = ["aggregates", "drift_m_per_s/0"];
    assert_eq!(found, expected.map(|field| format!("/water/snow/{field}")));
}

#[test]
fn deep_codes_need_a_file_that_has_them() {
    let error = only_error(json!({"camera": {"bits": 12}}));
    assert_eq!(error.pointer, "/camera/bits");
    assert!(error.message.contains("8 or 16"), "{}", error.message);
    let error = only_error(json!({"camera": {"bits": 16}, "encode": {"format": "webp"}}));
    assert_eq!(error.pointer, "/camera/bits");
    let error = only_error(json!({"camera": {"bits": 16, "jpeg": {}}}));
    assert_eq!(error.pointer, "/camera/bits");
    job_with(json!({"camera": {"bits": {"choice": [8, 16]}}}));
}
