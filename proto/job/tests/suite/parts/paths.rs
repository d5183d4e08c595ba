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
