//! When the style network runs, and what happens where it cannot.

use serde_json::json;

use crate::common::{Files, engine, engine_without_runtime, file, try_render};

#[test]
fn without_the_runtime_a_styled_frame_fails_for_good_and_says_what_to_run() {
    let files = Files::new();
    let job = files.job(&json!({"water": {"style": "atlantic"}}));
    let error = try_render(&job, &engine_without_runtime()).unwrap_err();
    assert!(!error.retryable());
    assert!(
        error.to_string().contains("scripts/get-onnxruntime.sh"),
        "{error}"
    );
}

#[test]
fn with_alpha_zero_no_network_runs() {
    let files = Files::new();
    let job =
        files.job(&json!({"water": {"style": "atlantic"}, "alpha": 0.0, "artifacts": ["rgb", "clean"]}));
    let rendered = try_render(&job, &engine_without_runtime()).unwrap();
    assert_eq!(file(&rendered, "rgb"), file(&rendered, "clean"));
    assert!(!rendered.record.provenance.inputs.contains_key("style.atlantic"));
}

#[test]
fn alpha_leads_from_the_water_to_the_style() {
    let files = Files::new();
    let engine = engine();
    let red = |alpha: f64| {
        let job = files.job(&json!({"water": {"style": "atlantic"}, "alpha": alpha}));
        let rendered = try_render(&job, &engine).unwrap();
        let picture = imaging::codec::decode_picture(file(&rendered, "rgb"))
            .unwrap()
            .to_rgb8();
        picture.pixels().map(|[red, ..]| u64::from(red)).sum::<u64>()
    };
    let (air, half, styled) = (red(0.0), red(0.5), red(1.0));
    assert!(air > half && half > styled, "red fades: {air} {half} {styled}");
}

#[test]
fn a_styled_frame_names_the_model_and_the_runtime() {
    let files = Files::new();
    let rendered = try_render(&files.job(&json!({"water": {"style": "muddy"}})), &engine()).unwrap();
    let provenance = &rendered.record.provenance;
    assert_eq!(provenance.inputs["style.muddy"].len(), 64);
    assert!(
        provenance
            .onnx_runtime
            .as_ref()
            .is_some_and(|version| version.starts_with("1."))
    );
}
