//! Cameras and poses of a sequence as a text model of COLMAP: `cameras.txt`, `images.txt` and an empty `points3D.txt`.
//!
//! COLMAP's camera axes are those of the record (right, down, ahead), its poses lead from the world to the camera, and the center
//! of its first pixel is (0.5, 0.5).

use std::fmt::Write;

use spec::Distortion;

use crate::commands::dataset::export::formats::quaternion::quaternion;
use crate::commands::dataset::export::formats::view::View;

/// Offset of COLMAP's coordinates from indices, in which the center of the first pixel is (0, 0).
pub(crate) const HALF_PIXEL: f64 = 0.5;

/// A frame of the model.
pub(crate) struct Shot {
    /// Path of the picture below the folder of pictures.
    pub(crate) name: String,
    pub(crate) view: View,
}

/// The files of a model by name.
pub(crate) fn model(shots: &[Shot]) -> [(&'static str, String); 3] {
    let mut cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, FX, FY, CX, CY\n".to_owned();
    let mut images =
        "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then the points seen: none\n".to_owned();
    let mut known: Vec<&View> = Vec::new();
    for (index, Shot { name, view }) in shots.iter().enumerate() {
        let lens = |view: &View| (view.width, view.height, view.intrinsics, view.distortion);
        let camera = known
            .iter()
            .position(|other: &&View| lens(other) == lens(view))
            .unwrap_or_else(|| {
                known.push(view);
                let id = known.len();
                // Writing to a string cannot fail, here and below.
                let _ = writeln!(cameras, "{id} {}", camera(view));
                id - 1
            });
        let [w, x, y, z] = quaternion(view.axes());
        let [tx, ty, tz] = translation(view);
        let (id, camera) = (index + 1, camera + 1);
        let _ = writeln!(images, "{id} {w} {x} {y} {z} {tx} {ty} {tz} {camera} {name}\n");
    }
    let points = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK: none, poses are exact\n".to_owned();
    [
        ("cameras.txt", cameras),
        ("images.txt", images),
        ("points3D.txt", points),
    ]
}

fn camera(view: &View) -> String {
    let spec::Intrinsics { focal_px, cx, cy } = view.intrinsics;
    let (width, height) = (view.width, view.height);
    let (cx, cy) = (cx + HALF_PIXEL, cy + HALF_PIXEL);
    let pinhole = format!("{width} {height} {focal_px} {focal_px} {cx} {cy}");
    match view.distortion {
        None => format!("PINHOLE {pinhole}"),
        // The rational model; its denominator stays 1.
        Some(Distortion { k1, k2, k3, p1, p2 }) => {
            format!("FULL_OPENCV {pinhole} {k1} {k2} {p1} {p2} {k3} 0 0 0")
        }
    }
}

/// -R c, R from the world to the camera, c the place of the camera.
fn translation(view: &View) -> [f64; 3] {
    let center = view.position();
    view.axes()
        .map(|axis| 0.0 - (0..3).map(|at| axis[at] * center[at]).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use spec::Intrinsics;

    use super::*;

    fn view(axes: [[f64; 3]; 3], center: [f64; 3]) -> View {
        let row = |at: usize| [axes[0][at], axes[1][at], axes[2][at], center[at]];
        View {
            width: 96,
            height: 64,
            intrinsics: Intrinsics::centered(50.0, 96, 64),
            distortion: None,
            world_from_camera: [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]],
            baseline_m: None,
        }
    }

    /// The rotation of a quaternion, by the usual formula.
    fn rotated([w, x, y, z]: [f64; 4], p: [f64; 3]) -> [f64; 3] {
        [
            (1.0 - 2.0 * (y * y + z * z)) * p[0]
                + 2.0 * (x * y - w * z) * p[1]
                + 2.0 * (x * z + w * y) * p[2],
            2.0 * (x * y + w * z) * p[0]
                + (1.0 - 2.0 * (x * x + z * z)) * p[1]
                + 2.0 * (y * z - w * x) * p[2],
            2.0 * (x * z - w * y) * p[0]
                + 2.0 * (y * z + w * x) * p[1]
                + (1.0 - 2.0 * (x * x + y * y)) * p[2],
        ]
    }

    #[test]
    fn quaternion_and_translation_take_the_world_to_the_camera() {
        let turns = [
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
            [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
            [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
            [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
            [[0.6, 0.8, 0.0], [0.0, 0.0, -1.0], [-0.8, 0.6, 0.0]],
        ];
        for axes in turns {
            let view = view(axes, [1.0, -2.0, 3.0]);
            let point = [0.5, 4.0, -1.0];
            let expected = axes.map(|axis| {
                (0..3)
                    .map(|at| axis[at] * (point[at] - view.position()[at]))
                    .sum::<f64>()
            });
            let (turned, shift) = (rotated(quaternion(view.axes()), point), translation(&view));
            for at in 0..3 {
                assert!((turned[at] + shift[at] - expected[at]).abs() < 1e-12, "{axes:?}");
            }
        }
    }

    #[test]
    fn frames_of_one_lens_share_a_camera_whose_center_counts_from_the_corner() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let shot = |x: f64| Shot {
            name: format!("{x}.png"),
            view: view(axes, [x, 0.0, 0.0]),
        };
        let [(_, cameras), (_, images), _] = model(&[shot(0.0), shot(1.0)]);
        let lines: Vec<&str> = cameras.lines().skip(1).collect();
        assert_eq!(lines, ["1 PINHOLE 96 64 50 50 48 32"]);
        assert!(images.contains("\n2 1 0 0 0 -1 0 0 1 1.png\n\n"), "{images}");
    }
}
