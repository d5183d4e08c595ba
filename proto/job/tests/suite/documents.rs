use serde_json::{Value, json};
use spec::{ArtifactKind, Camera, Encode, Fidelity, HazeBlend, HoleRule, Job, RangeKind, Scene};

use crate::common::{document_with, errors, job, job_with, parameters, vocabulary};

const LEAST: &str = concat!(
    r#"{"alpha":1.0,"artifacts":["rgb"],"camera":{"bits":8,"frames_per_s":25.0,"height":492,"hfov_deg":80.0,"supersample":1,"tone":"srgb","width":768},"count":1,"#,
    r#""dataset":"default","daylight":"auto","encode":{"format":"png"},"enhance":[],"fidelity":"picture","labels":{},"#,
    r#""lights":[],"metrics":["entropy","uicm","uism","uiconm","uiqm","uciqe"],"#,
    r#""scene":{"family":"structure","kind":"procedural","lighting":"water","seed":0},"seed":0,"#,
    r#""water":{"holes":"background","range_scale":1.0}}"#,
);

/// One of everything.
fn everything() -> Value {
    json!({
        "dataset": "shaft-v1", "count": 1000, "seed": 42,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}, "lighting": "in_air"},
        "daylight": "none",
        "camera": {"width": 640, "height": 480, "hfov_deg": {"uniform": [60, 90]}},
        "water": {"optics": {"choice": ["jerlov-1C", "jerlov-3C"]}, "range_scale": {"uniform": [0.5, 2.0]},
            "style": {"choice": ["atlantic", "mediterranean", "muddy"], "weights": [1, 1, 2]},
            "depth_m": 4, "holes": {"range_m": 20}},
        "alpha": {"uniform": [0.0, 1.0]},
        "lights": [{"kind": "haze", "x": {"uniform": [0, 1]}, "y": 1.0, "size": 0.2,
            "intensity": {"normal": [0.8, 0.1], "clip": [0, 1]}, "color": [1, 1, {"grid": [0.5, 1]}],
            "blend": "add", "space": "display"}],
        "enhance": ["hscm", {"method": "hscm", "name": "wide", "cutoff": {"uniform": [16, 64]}, "mask": "paper"},
            {"name": "mine", "steps": [{"gray_world": {}}, {"clahe": {"clip": 3}}]}], "metrics": ["uiqm@table1", "psnr"], "fidelity": {"terms": 6},
        "artifacts": ["rgb", "range", "enhanced.hscm", "enhanced.wide.mask", "enhanced.mine.1"],
        "encode": {"format": "jpeg", "quality": 80},
        "labels": {"run": "exp-41", "n": 2.0, "choice": true, "t": {"log_uniform": [1, 10]}},
    })
}

#[test]
fn the_least_description_gets_every_default() {
    assert_eq!(job(&document_with(json!({}))).canonical(), LEAST);
}

#[test]
fn the_canonical_form_is_a_fixed_point() {
    for document in [document_with(json!({})), everything()] {
        let first = job(&document);
        let second = Job::parse(first.canonical().as_bytes(), &vocabulary(false)).unwrap();
        assert_eq!(first.canonical(), second.canonical());
        assert_eq!(first.digest(), second.digest());
        for index in [0, 1, first.frames() - 1] {
            assert_eq!(first.resolve(index), second.resolve(index));
        }
    }
}

#[test]
fn order_spacing_and_the_form_of_numbers_do_not_change_the_digest() {
    let submitted = br#"{"scene":{"kind":"procedural","family":"structure","seed":7},"alpha":0.50,"count":10,"water":{"style":"muddy"}}"#;
    let other = br#"{ "count": 1e1, "alpha": 5e-1, "scene": {"seed": 7.0, "family": "structure", "kind": "procedural"},
        "water": {"range_scale": 1, "style": "muddy"}, "labels": {} }"#;
    let [one, other] = [&submitted[..], &other[..]].map(|text| Job::parse(text, &vocabulary(false)).unwrap());
    assert_eq!(one.canonical(), other.canonical());
    assert_eq!(one.digest(), other.digest());
    assert_eq!(one.digest().len(), 64);
    assert_ne!(
        one.digest(),
        job_with(json!({"alpha": 0.5, "count": 10})).digest()
    );
}

#[test]
fn minus_zero_is_zero_and_a_large_seed_is_kept_exactly() {
    let job = job_with(json!({"alpha": -0.0, "seed": u64::MAX}));
    assert!(job.canonical().contains(r#""alpha":0.0"#));
    assert!(job.canonical().contains(r#""seed":18446744073709551615"#));
    assert_eq!(job.seed(), u64::MAX);
    assert_eq!(job.resolve(0).unwrap().seed, u64::MAX);
}

#[test]
fn parameters_are_the_resolved_description_without_count() {
    let mut expected: Value = serde_json::from_str(LEAST).unwrap();
    expected.as_object_mut().unwrap().remove("count");
    assert_eq!(parameters(&job(&document_with(json!({}))), 0), expected);
}

#[test]
fn a_frame_has_the_values_of_its_parameters() {
    let job = job(&everything());
    assert_eq!((job.frames(), job.dataset()), (2000, "shaft-v1"));
    assert_eq!(job.styles(), ["atlantic", "mediterranean", "muddy"]);
    let frame = job.resolve(1).unwrap();
    assert_eq!(
        (frame.index, frame.seed, frame.dataset.as_str()),
        (1, 42, "shaft-v1")
    );
    let Scene::Procedural { family, seed, .. } = &frame.scene else {
        panic!("{:?}", frame.scene)
    };
    assert_eq!(family, "structure");
    assert_eq!(frame.parameters["scene"]["seed"], json!(seed));
    assert_eq!((frame.camera.width, frame.camera.height), (640, 480));
    assert_eq!(
        frame.parameters["camera"]["hfov_deg"].as_f64(),
        Some(frame.camera.hfov_deg)
    );
    assert_eq!(frame.parameters["alpha"].as_f64(), Some(frame.alpha));
    assert_eq!(frame.water.holes, HoleRule::RangeM(20.0));
    assert_eq!(frame.water.depth_m, Some(4.0));
    let light = frame.haze()[0];
    assert_eq!(
        (light.y, light.blend, light.color),
        (1.0, HazeBlend::Add, [1.0, 1.0, 1.0])
    );
    assert_eq!(job.resolve(0).unwrap().haze()[0].color, [1.0, 1.0, 0.5]);
    assert_eq!(frame.fidelity, Fidelity::Terms(6));
    assert_eq!(frame.artifacts[2], ArtifactKind::Enhanced("hscm".to_owned()));
    assert_eq!(frame.encode, Encode::Jpeg { quality: 80 });
    assert_eq!(frame.labels["run"], json!("exp-41"));
    assert_eq!(frame.labels["n"], json!(2));
    assert_eq!(frame.labels["choice"], json!(true));
}

#[test]
fn presets_are_stored_by_their_full_name() {
    for optics in [
        json!("jerlov-3C"),
        json!("jerlov-3C/williamson2022"),
        json!({"preset": "jerlov-3C"}),
    ] {
        let frame = job_with(json!({"water": {"optics": optics}})).resolve(0).unwrap();
        assert_eq!(
            frame.parameters["water"]["optics"],
            json!({"phase": "ff", "preset": "jerlov-3C/williamson2022"})
        );
        assert_eq!(
            frame.water.optics.unwrap().preset.as_deref(),
            Some("jerlov-3C/williamson2022")
        );
    }
}

#[test]
fn a_jpeg_has_a_quality_and_no_other_format_has() {
    let encode = |format: &str| {
        job_with(json!({"encode": {"format": format}}))
            .resolve(0)
            .unwrap()
            .encode
    };
    assert_eq!(encode("jpeg"), Encode::Jpeg { quality: 95 });
    assert_eq!(encode("webp"), Encode::Webp);
}

#[test]
fn uploaded_scenes_are_listed_whether_chosen_or_not() {
    let job = job(&json!({"scene": {"choice": [
        {"kind": "uploaded", "id": {"grid": ["scn_b", "scn_a"]}},
        {"kind": "uploaded", "id": "scn_c"},
        {"kind": "procedural", "family": "structure"}]}}));
    assert_eq!(job.uploaded_scene_ids(), ["scn_a", "scn_b", "scn_c"]);
    assert_eq!(job_with(json!({})).uploaded_scene_ids(), [""; 0]);
}

#[test]
fn files_are_accepted_only_with_a_local_vocabulary() {
    let text = json!({"scene": {"kind": "files", "rgb": "a.png", "z_depth": "d.png", "unit_m": 0.001,
        "invalid_code": 0}});
    let frame = Job::parse(text.to_string().as_bytes(), &vocabulary(true))
        .unwrap()
        .resolve(0)
        .unwrap();
    let files = frame.scene.files().unwrap();
    let range = files.range.unwrap();
    assert_eq!(
        (files.rgb, range.file, range.kind),
        ("a.png", "d.png", RangeKind::ZDepth)
    );
    assert_eq!((range.unit_m, range.invalid_code), (Some(0.001), Some(0)));

    let alone = json!({"scene": {"kind": "files", "rgb": "a.png"}}).to_string();
    let frame = Job::parse(alone.as_bytes(), &vocabulary(true))
        .unwrap()
        .resolve(0)
        .unwrap();
    let files = frame.scene.files().unwrap();
    assert_eq!((files.rgb, files.range), ("a.png", None));
}

#[test]
fn fields_without_effect_are_rejected() {
    let refused = |document: Value| {
        let found = errors(&document);
        assert_eq!(found.len(), 1, "{document}: {found:#?}");
        (found[0].pointer.clone(), found[0].message.clone())
    };
    let scene = || json!({"kind": "procedural", "family": "structure"});
    let (pointer, message) = refused(json!({"scene": scene(), "alpha": 0.5}));
    assert_eq!(pointer, "/alpha");
    assert_eq!(
        message,
        "`alpha` is 0.5, but needs `water.style`: add it, or remove `alpha`"
    );
    job_with(json!({"alpha": 0.5, "water": {"style": "muddy"}}));
    let (pointer, _) = refused(json!({"scene": scene(), "water": {"range_scale": 2}}));
    assert_eq!(pointer, "/water/range_scale");
    let uploaded =
        json!({"scene": {"kind": "uploaded", "id": "scn_1"}, "camera": {"width": 9, "hfov_deg": 60}});
    let (pointer, message) = refused(uploaded);
    assert_eq!(pointer, "/camera/width");
    assert!(message.contains("needs a procedural scene"), "{message}");
}

#[test]
fn a_value_equal_to_the_default_needs_nothing() {
    job_with(json!({"water": {"range_scale": 1, "holes": "background"}}));
    job(&json!({"scene": {"kind": "uploaded", "id": "scn_1"}, "camera": {"width": 768, "height": 492}}));
}

#[test]
fn the_focal_length_follows_from_the_field_of_view() {
    let camera = Camera::pinhole(200, 100, 90.0);
    assert!((camera.focal_px(200) - 100.0).abs() < 1e-12);
}

#[test]
fn a_stored_job_keeps_its_meaning_when_names_change() {
    let accepted = job(&everything());
    let stored = Job::from_canonical(accepted.canonical()).unwrap();
    assert_eq!(stored.canonical(), accepted.canonical());
    assert_eq!(
        (stored.frames(), stored.dataset(), stored.seed(), stored.styles()),
        (
            accepted.frames(),
            accepted.dataset(),
            accepted.seed(),
            accepted.styles()
        )
    );
    for index in [0, 1, 7, 1999] {
        assert_eq!(stored.resolve(index).unwrap(), accepted.resolve(index).unwrap());
    }
    let earlier = accepted
        .canonical()
        .replace("\"muddy\"", "\"a-style-that-is-gone\"")
        .replace("williamson2022", "a-source-that-is-gone");
    assert_ne!(earlier, accepted.canonical());
    assert!(Job::parse(earlier.as_bytes(), &vocabulary(false)).is_err());
    let old = Job::from_canonical(&earlier).unwrap();
    assert_eq!(old.canonical(), earlier);
    assert!((0..old.frames().min(50)).all(|index| old.resolve(index).is_ok()));
    let wide = job_with(json!({"alpha": 0.5})).canonical().replace("0.5", "7.5");
    assert_eq!(
        Job::from_canonical(&wide).unwrap().resolve(0).unwrap().alpha,
        7.5,
        "a limit of then may have been wider"
    );
}

#[test]
fn a_damaged_job_is_an_error_and_no_panic() {
    let canonical = job(&everything()).canonical().to_owned();
    for at in (0..canonical.len())
        .step_by(3)
        .filter(|at| canonical.is_char_boundary(*at))
    {
        assert!(Job::from_canonical(&canonical[..at]).is_err());
        for byte in ["\"", "{", "9", "-", "null"] {
            let mut damaged = canonical.clone();
            damaged.replace_range(at..=at, byte);
            if let Ok(job) = Job::from_canonical(&damaged) {
                let _ = job.resolve(0);
            }
        }
    }
}
