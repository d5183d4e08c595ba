//! Views and paths of procedural scenes: values shared by the frames of a pass, and rejected inputs.

use serde_json::{Value, json};
use spec::{Frame, Scene};

use crate::common::{job_with, only_error};

fn seed(frame: &Frame) -> u64 {
    match frame.scene {
        Scene::Procedural { seed, .. } => seed,
        _ => unreachable!("every scene of these tests is procedural"),
    }
}

fn scene(seed: Value) -> Value {
    json!({"kind": "procedural", "family": "structure", "seed": seed})
}

fn frames(description: Value) -> Vec<Frame> {
    let job = job_with(description);
    (0..job.frames())
        .map(|index| job.resolve(index).unwrap())
        .collect()
}

#[test]
fn frames_of_a_pass_share_their_world_and_passes_differ() {
    let drawn = frames(json!({
        "scene": scene(json!({"int": [0, 1_000_000]})),
        "camera": {"path": {"frames": 5}, "view": {"pitch_deg": {"uniform": [-30, 40]}}, "hfov_deg": {"uniform": [60, 90]}},
        "water": {"optics": {"grid": ["jerlov-1C", "jerlov-3C"]}},
        "count": 15,
    }));
    assert_eq!(drawn.len(), 30);
    for (index, frame) in drawn.iter().enumerate() {
        let first = &drawn[index / 10 * 10];
        assert_eq!(seed(frame), seed(first), "frame {index}");
        assert_eq!(frame.camera.view, first.camera.view, "frame {index}");
        assert_eq!(frame.camera.path.unwrap().frame, index / 2 % 5);
    }
    assert!(seed(&drawn[0]) != seed(&drawn[10]) && seed(&drawn[10]) != seed(&drawn[20]));
    assert_ne!(drawn[0].camera.view, drawn[10].camera.view);
    assert_ne!(drawn[0].camera.hfov_deg, drawn[1].camera.hfov_deg);
}

#[test]
fn a_fixed_place_on_a_path_makes_each_frame_a_pass() {
    let description = |camera: Value| {
        let drawn = frames(json!({
            "scene": scene(json!({"int": [0, 1_000_000]})), "camera": camera, "count": 4,
        }));
        drawn.iter().map(seed).collect::<Vec<_>>()
    };
    let still = description(json!({}));
    assert_eq!(description(json!({"path": {"frames": 4, "frame": 2}})), still);
    assert_eq!(description(json!({"path": {"frames": 4}})), vec![still[0]; 4]);
}

#[test]
fn a_view_needs_a_procedural_scene_and_no_waypoints() {
    let view = json!({"pitch_deg": 10, "distance_m": {"uniform": [2, 4]}});
    let waypoint = |x: f64| json!({"position_m": [x, -3, 1], "target_m": [x, 0, 1]});
    let path = json!({"frames": 9, "start": waypoint(0.0), "end": waypoint(1.0)});
    let error = only_error(json!({"scene": scene(json!(1)), "camera": {"view": view, "path": path}}));
    assert_eq!(error.pointer, "/camera/view");
    let uploaded = json!({"kind": "uploaded", "id": "scn_a"});
    let error = only_error(json!({"scene": uploaded, "camera": {"view": view}}));
    assert_eq!(
        error.message,
        "`camera.view` is given, but needs a procedural scene: add it, or remove `camera.view`"
    );
    let error = only_error(json!({"camera": {"view": {"pitch_deg": 90}}}));
    assert_eq!(error.message, "`camera.view.pitch_deg` is 90; must be -85..=85");
}

#[test]
fn a_frame_knows_its_neighbors_on_the_path() {
    let job = job_with(json!({
        "scene": scene(json!({"int": [0, 1_000_000]})),
        "camera": {"path": {"frames": 3}, "hfov_deg": {"uniform": [60, 90]}},
        "water": {"optics": {"grid": ["jerlov-1C", "jerlov-3C"]}},
        "count": 4,
    }));
    let resolve = |index| job.resolve(index).unwrap();
    for index in 0..8 {
        let frame = resolve(index);
        let position = index / 2 % 3;
        let previous = frame.previous().unwrap();
        assert_eq!(previous, (position > 0).then(|| resolve(index - 2)), "{index}");
        let next = frame.next().unwrap();
        assert_eq!(
            next.as_ref().map(|next| next.index),
            (position < 2).then_some(index + 2)
        );
        if let Some(next) = next.filter(|next| next.index < 8) {
            assert_eq!(next, resolve(next.index));
            assert_eq!(next.previous().unwrap(), Some(frame));
        }
    }
    assert_eq!(job_with(json!({})).resolve(0).unwrap().next().unwrap(), None);
}

#[test]
fn the_neighbors_of_a_frame_at_a_fixed_position_differ_in_their_position_only() {
    let frame = job_with(json!({"camera": {"path": {"frames": 3, "frame": 1}}}))
        .resolve(0)
        .unwrap();
    let next = frame.next().unwrap().unwrap();
    assert_eq!(next.camera.path.unwrap().frame, 2);
    assert_eq!(next.parameters["camera"]["path"]["frame"], 2);
    assert_ne!(next.index, frame.index);
    assert_eq!(next.previous().unwrap(), Some(frame));
    assert_eq!(next.next().unwrap(), None);
}

#[test]
fn flow_needs_a_path_of_several_frames_and_a_global_shutter() {
    let messages = |fields: Value| {
        let error = only_error(fields);
        (error.pointer, error.message)
    };
    assert_eq!(
        messages(json!({"artifacts": ["flow"]})),
        (
            "/artifacts/0".to_owned(),
            "the artifact \"flow\" needs `camera.path`: add it, or remove the artifact".to_owned()
        )
    );
    let (pointer, message) = messages(json!({"artifacts": ["flow"], "camera": {"path": {"frames": 1}}}));
    assert_eq!(pointer, "/camera/path/frames");
    assert!(message.starts_with("`camera.path.frames` is 1, but"), "{message}");
    let path = json!({"frames": 9});
    let (pointer, message) = messages(
        json!({"artifacts": ["flow"], "camera": {"path": path, "readout_s": {"uniform": [0, 0.02]}}}),
    );
    assert_eq!(pointer, "/camera/readout_s");
    assert!(
        message.contains("`camera.readout_s` is 0.02, but the artifact \"flow\""),
        "{message}"
    );
    job_with(json!({"artifacts": ["flow"], "camera": {"path": path, "readout_s": 0}}));
}

#[test]
fn a_stereo_pair_needs_a_baseline_a_procedural_scene_and_an_artifact() {
    let uploaded = json!({"kind": "uploaded", "id": "scn_a"});
    let stereo = |baseline: Value| json!({"stereo": {"baseline_m": baseline}});
    for (fields, pointer) in [
        (json!({"camera": stereo(json!(0.1))}), "/camera/stereo"),
        (
            json!({"camera": stereo(json!(0)), "artifacts": ["disparity"]}),
            "/camera/stereo/baseline_m",
        ),
        (
            json!({"camera": stereo(json!(10.1)), "artifacts": ["rgb_right"]}),
            "/camera/stereo/baseline_m",
        ),
        (json!({"artifacts": ["rgb_right"]}), "/artifacts/0"),
        (
            json!({"scene": uploaded, "camera": stereo(json!(0.1)), "artifacts": ["rgb_right"]}),
            "/camera/stereo",
        ),
    ] {
        assert_eq!(only_error(fields.clone()).pointer, pointer, "{fields}");
    }
    let job = job_with(json!({"camera": stereo(json!({"uniform": [0.05, 10]})), "artifacts": ["rgb_right"]}));
    assert!(job.resolve(0).unwrap().camera.is_pinhole());
}
