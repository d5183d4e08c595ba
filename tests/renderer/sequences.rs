//! Motion along paths, stereo pairs and previous pictures.

mod metrics;
mod motion;
mod previous;
mod stereo;

use imaging::{Plane, Rgb, Rgb8};
use renderer::{Content, Contents, SceneSource, Slot};
use serde_json::{Value, json};
use spec::{ArtifactKind, Intrinsics, SceneRecord};

use crate::common::{engine_without_runtime, parse};

const SIZE: (usize, usize) = (120, 80);

/// A job of procedural scenes with these fields of the description and of its camera.
pub(crate) fn describe(camera: &Value, fields: &Value) -> Value {
    let mut description = json!({
        "scene": {"kind": "procedural", "family": "pipeline", "seed": 3},
        "camera": {"width": SIZE.0, "height": SIZE.1},
        "metrics": [],
    });
    for (place, values) in [("/camera", camera), ("", fields)] {
        for (name, value) in values.as_object().unwrap() {
            description.pointer_mut(place).unwrap()[name] = value.clone();
        }
    }
    description
}

pub(crate) fn contents(description: &Value, frame: u64) -> Contents {
    let frame = parse(description).resolve(frame).unwrap();
    let mut slot = Slot::new(&engine_without_runtime());
    slot.contents(&frame, &SceneSource::Local).unwrap()
}

pub(crate) fn content<'a>(contents: &'a Contents, name: &str) -> &'a Content<'static> {
    let kind = ArtifactKind::parse(name).unwrap();
    let found = contents.artifacts.iter().find(|(own, _)| *own == kind);
    &found
        .unwrap_or_else(|| panic!("no {name}: {:?}", contents.record.warnings))
        .1
}

pub(crate) fn linear<'a>(contents: &'a Contents, name: &str) -> &'a Rgb<f32> {
    match content(contents, name) {
        Content::Linear(layer) => layer,
        other => panic!("{other:?}"),
    }
}

pub(crate) fn picture<'a>(contents: &'a Contents, name: &str) -> &'a Rgb8 {
    match content(contents, name) {
        Content::Picture(picture) => picture,
        other => panic!("{other:?}"),
    }
}

pub(crate) fn range(contents: &Contents) -> &Plane<f32> {
    match content(contents, "range") {
        Content::Range(range) => range,
        other => panic!("{other:?}"),
    }
}

pub(crate) fn scene(contents: &Contents) -> &SceneRecord {
    contents.record.scene.as_ref().unwrap()
}

/// Waypoints of a level camera at the usual view, and of one moved by these meters to its right, down and ahead.
pub(crate) fn moved_path(frames: usize, [right_m, down_m, ahead_m]: [f64; 3]) -> Value {
    let matrix = scene(&contents(&describe(&json!({}), &json!({})), 0))
        .world_from_camera
        .unwrap();
    let column = |i: usize| [0, 1, 2].map(|row| matrix[row][i]);
    let (ahead, place) = (column(2), column(3));
    let level = (ahead[0] * ahead[0] + ahead[1] * ahead[1]).sqrt();
    let right = [ahead[1] / level, -ahead[0] / level, 0.0];
    let down = [
        ahead[1] * right[2] - ahead[2] * right[1],
        ahead[2] * right[0] - ahead[0] * right[2],
        ahead[0] * right[1] - ahead[1] * right[0],
    ];
    let waypoint = |share: f64| {
        let position = [0, 1, 2]
            .map(|i| place[i] + share * (right_m * right[i] + down_m * down[i] + ahead_m * ahead[i]));
        let target = [0, 1, 2].map(|i| position[i] + 4.0 * ahead[i]);
        json!({"position_m": position, "target_m": target})
    };
    json!({"frames": frames, "start": waypoint(0.0), "end": waypoint(1.0)})
}

/// A point in camera axes, and back, by the record's matrix.
pub(crate) fn to_world(matrix: &[[f64; 4]; 4], point: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|row| (0..3).map(|i| matrix[row][i] * point[i]).sum::<f64>() + matrix[row][3])
}

pub(crate) fn to_camera(matrix: &[[f64; 4]; 4], point: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        (0..3)
            .map(|row| matrix[row][i] * (point[row] - matrix[row][3]))
            .sum()
    })
}

/// The point at this range along the ray of a pixel of a pinhole.
pub(crate) fn along(camera: &Intrinsics, [x, y]: [f64; 2], meters: f64) -> [f64; 3] {
    let ray = [
        (x - camera.cx) / camera.focal_px,
        (y - camera.cy) / camera.focal_px,
        1.0,
    ];
    let length = ray.iter().map(|v| v * v).sum::<f64>().sqrt();
    ray.map(|v| v / length * meters)
}
