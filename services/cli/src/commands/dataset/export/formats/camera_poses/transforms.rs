//! Cameras and poses of a sequence as the `transforms.json` of nerfstudio: camera axes right, up, back, from the camera to the world.

use serde_json::{Value, json};
use spec::Distortion;

use crate::commands::dataset::export::formats::colmap::{HALF_PIXEL, Shot};
use crate::commands::dataset::export::formats::view::View;

pub(crate) const TRANSFORMS: &str = "transforms.json";

/// The file of a sequence, with paths relative to its folder. Each frame has its intrinsics, since they may vary.
pub(crate) fn transforms(shots: &[Shot], folder: &str) -> String {
    let frames = shots.iter().map(|Shot { name, view }| {
        let mut frame = intrinsics(view);
        frame["file_path"] = format!("{folder}/{name}").into();
        frame["transform_matrix"] = json!(matrix(view));
        frame
    });
    let frames: Vec<Value> = frames.collect();
    let file = json!({"camera_model": "OPENCV", "orientation_override": "none", "frames": frames});
    format!("{file:#}\n")
}

fn intrinsics(view: &View) -> Value {
    let spec::Intrinsics { focal_px, cx, cy } = view.intrinsics;
    let Distortion { k1, k2, k3, p1, p2 } = view.distortion.unwrap_or_default();
    let mut frame = json!({
        "w": view.width, "h": view.height, "fl_x": focal_px, "fl_y": focal_px,
        "cx": cx + HALF_PIXEL, "cy": cy + HALF_PIXEL, "k1": k1, "k2": k2, "p1": p1, "p2": p2
    });
    if k3 != 0.0 {
        frame["k3"] = k3.into();
    }
    frame
}

/// From right, up, back: the second and the third axis turn around.
fn matrix(view: &View) -> [[f64; 4]; 4] {
    view.world_from_camera
        .map(|[right, down, ahead, place]| [right, 0.0 - down, 0.0 - ahead, place])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_camera_that_looks_north_has_its_up_axis_up() {
        // World: x east, y north, z up. Camera: right = east, down = -z, ahead = north.
        let view = View {
            width: 4,
            height: 2,
            intrinsics: spec::Intrinsics::centered(3.0, 4, 2),
            distortion: None,
            world_from_camera: [
                [1.0, 0.0, 0.0, 7.0],
                [0.0, 0.0, 1.0, 8.0],
                [0.0, -1.0, 0.0, 9.0],
                [0.0, 0.0, 0.0, 1.0],
            ],
            baseline_m: None,
        };
        let expected = [
            [1.0, 0.0, 0.0, 7.0],
            [0.0, 0.0, -1.0, 8.0],
            [0.0, 1.0, 0.0, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        assert_eq!(matrix(&view), expected);
        let shots = [Shot {
            name: "a.png".to_owned(),
            view,
        }];
        let file: Value = serde_json::from_str(&transforms(&shots, "images")).unwrap();
        assert_eq!(file["frames"][0]["file_path"], "images/a.png");
        assert_eq!(
            (&file["frames"][0]["cx"], &file["frames"][0]["cy"]),
            (&json!(2.0), &json!(1.0))
        );
    }
}
