//! The water stage on unusual scenes, and the records it writes.

use renderer::{SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, pixels, render, try_render};

#[test]
fn a_scene_without_range_passes_the_water_as_it_is() {
    let files = Files::new();
    let artifacts = json!(["rgb", "clean"]);
    let water = json!({"optics": "jerlov-9C"});
    let fields = json!({"scene": files.scene_without_range(), "water": water, "artifacts": artifacts});
    let rendered = render(&files.stored_job(&fields));
    assert_eq!(pixels(&rendered, "rgb"), pixels(&rendered, "clean"));
    assert_eq!(
        rendered.record.warnings,
        ["the scene has no range: the water's optics are skipped"]
    );
    assert!(rendered.record.optics.is_empty());
    let stages = rendered.record.plan.as_array().unwrap();
    assert!(
        stages.iter().all(|stage| stage["variant"] == "skip"),
        "{stages:?}"
    );
}

#[test]
fn a_frame_of_holes_shows_the_veil_alone() {
    let files = Files::new();
    let water =
        json!({"optics": {"beam_attenuation_per_m": [0.5, 0.3, 0.2], "veiling_light": [0.1, 0.2, 0.3]}});
    let fields = json!({"scene": files.scene("holes.npy"), "water": water});
    let rendered = render(&files.job(&fields));
    let picture = imaging::codec::decode_picture(file(&rendered, "rgb"))
        .unwrap()
        .to_rgb8();
    let veil = [0.1, 0.2, 0.3].map(|light| (255.0 * imaging::transfer::encode(light) + 0.5) as u8);
    assert!(picture.pixels().all(|pixel| pixel == veil));
    assert_eq!(
        rendered.record.warnings,
        [
            "no pixel has a valid range",
            "the standard deviation of the picture is below one code"
        ]
    );
}

#[test]
fn holes_under_the_rule_reject_fail_for_good() {
    let files = Files::new();
    let water = json!({"optics": {"preset": "jerlov-3C", "veil_gain": 1}, "holes": "reject"});
    let error = try_render(&files.job(&json!({"water": water})), &engine_without_runtime()).unwrap_err();
    assert!(!error.retryable());
    assert_eq!(
        error.to_string(),
        "1 pixels have no valid range and the rule for holes is `reject`"
    );
}

#[test]
fn a_file_that_is_not_there_is_named_and_fails_for_good() {
    let files = Files::new();
    let scene = json!({"kind": "files", "rgb": "/nowhere/rgb.png"});
    let error = try_render(&files.job(&json!({"scene": scene})), &engine_without_runtime()).unwrap_err();
    assert!(!error.retryable());
    assert!(
        error.to_string().starts_with("cannot read /nowhere/rgb.png: "),
        "{error}"
    );
}

#[test]
fn the_record_says_what_was_done() {
    let files = Files::new();
    let rendered = render(&files.job(&json!({
        "water": {"optics": "jerlov-3C", "range_scale": 2.0}, "enhance": ["hscm"],
        "metrics": ["uiqm", "uiqm@table1", "psnr"]})));
    let record = &rendered.record;
    assert_eq!(record.optics["preset"], json!("jerlov-3C/williamson2022"));
    assert!(
        record.optics["beam_attenuation_per_m"]
            .as_array()
            .is_some_and(|rgb| rgb.len() == 3)
    );
    let chebyshev = |stage: &&Value| stage["variant"] == "chebyshev" && stage["terms"].as_u64() > Some(1);
    assert_eq!(
        record.plan.as_array().unwrap().iter().filter(chebyshev).count(),
        3
    );
    for subject in ["rgb", "hscm"] {
        let metrics: Vec<&str> = record.measurements[subject].keys().map(String::as_str).collect();
        assert_eq!(metrics, ["psnr", "uiqm", "uiqm@table1"]);
    }
    for stage in [
        "scene", "plan", "water", "style", "haze", "encode", "enhance", "metrics", "files", "total",
    ] {
        assert!(record.timings_ms.contains_key(stage), "{stage}");
    }
    let inputs: Vec<&str> = record.provenance.inputs.keys().map(String::as_str).collect();
    assert_eq!(inputs, ["scene.range", "scene.rgb"]);
    assert_eq!(record.provenance.onnx_runtime, None);
}

#[test]
fn a_slot_remembers_nothing_that_changes_a_frame() {
    let files = Files::new();
    let waters = json!({"optics": {"choice": ["jerlov-1C", "jerlov-9C", "jerlov-3C"]}, "range_scale": {"uniform": [0.5, 4]}});
    let job = files.job(&json!({"water": waters, "count": 6, "metrics": ["uciqe", "ssim"]}));
    let mut used = Slot::new(&engine_without_runtime());
    for index in 0..6 {
        let frame = job.resolve(index).unwrap();
        let again = used.render(&frame, &SceneSource::Local).unwrap();
        let fresh = Slot::new(&engine_without_runtime())
            .render(&frame, &SceneSource::Local)
            .unwrap();
        assert_eq!(again.files, fresh.files);
        assert_eq!(again.record.digest(), fresh.record.digest());
        assert_eq!(again.record.measurements, fresh.record.measurements);
    }
}

#[test]
fn a_k_d_in_place_of_the_beam_attenuation_is_said_in_the_answer_and_in_the_record() {
    let files = Files::new();
    let words = "decay of daylight with depth";
    let of = |beam: Value, more: Value| {
        let mut optics = json!({"beam_attenuation_per_m": beam, "veiling_light": [0, 0.1, 0.1]});
        optics["diffuse_attenuation_per_m"] = more;
        if optics["diffuse_attenuation_per_m"].is_null() {
            optics
                .as_object_mut()
                .unwrap()
                .remove("diffuse_attenuation_per_m");
        }
        files.job(&json!({"water": {"optics": optics}}))
    };
    let tabulated = of(json!([0.40, 0.089, 0.068]), Value::Null);
    let beside = of(json!([0.2, 0.3, 0.4]), json!([0.2, 0.3, 0.4]));
    for job in [tabulated, beside] {
        assert!(
            job.warnings().iter().any(|warning| warning.contains(words)),
            "{:?}",
            job.warnings()
        );
        let warnings = render(&job).record.warnings;
        assert!(
            warnings.iter().any(|warning| warning.contains(words)),
            "{warnings:?}"
        );
    }
    let beam = of(json!([0.778, 0.546, 0.594]), json!([0.45, 0.12, 0.25]));
    assert!(beam.warnings().is_empty(), "{:?}", beam.warnings());
    assert!(
        render(&beam)
            .record
            .warnings
            .iter()
            .all(|warning| !warning.contains(words))
    );
}
