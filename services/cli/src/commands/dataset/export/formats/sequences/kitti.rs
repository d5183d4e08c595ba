//! Cameras, times and poses of a sequence as in the odometry benchmark of KITTI.

use spec::Intrinsics;

use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::sequences::layout::{depth_codes_per_m, format_seconds};
use crate::commands::dataset::export::formats::sequences::orb_slam::{SETTINGS, settings};
use crate::commands::dataset::export::formats::sequences::sequence::{Sequence, TextFile};
use crate::commands::dataset::export::formats::view::View;

/// `calib.txt`, `times.txt` and settings for ORB-SLAM next to the pictures.
pub(super) fn texts(sequence: &Sequence) -> Vec<TextFile> {
    let Some(first) = sequence.frames.first() else {
        return Vec::new();
    };
    let times = sequence.frames.iter().map(|frame| {
        let since = frame.stamp_ns - first.stamp_ns;
        format_seconds(since) + "\n"
    });
    let settings = settings(&first.view, sequence.rate_hz(), depth_codes_per_m(Format::Kitti));
    vec![
        TextFile::new(&[], "calib.txt", calibrate(&first.view)),
        TextFile::new(&[], "times.txt", times.collect()),
        TextFile::new(&[], SETTINGS, settings),
    ]
}

/// Projection matrices of the left (P0, P2) and the right camera (P1, P3), which are the left one without a stereo pair.
fn calibrate(view: &View) -> String {
    let Intrinsics { focal_px: f, cx, cy } = view.intrinsics;
    let shift = 0.0 - f * view.baseline_m.unwrap_or(0.0);
    let [left, right] = [0.0, shift].map(|shift| format!("{f} 0 {cx} {shift} 0 {f} {cy} 0 0 0 1 0"));
    format!("P0: {left}\nP1: {right}\nP2: {left}\nP3: {right}\n")
}

/// Poses from the axes of the camera to those of the first frame: right, down, ahead.
pub(super) fn list_poses(sequence: &Sequence) -> String {
    let Some(first) = sequence.frames.first().map(|frame| &frame.view) else {
        return String::new();
    };
    let lines = sequence.frames.iter().map(|frame| {
        let rows = first.axes().map(|axis| format_row(axis, first, &frame.view));
        rows.join(" ") + "\n"
    });
    lines.collect()
}

/// The row of the matrix from the camera of a frame to the first one that belongs to an axis of the first one.
fn format_row(axis: [f64; 3], first: &View, view: &View) -> String {
    let [x, y, z] = view.axes().map(|other| dot(axis, other));
    let offset = [0, 1, 2].map(|at| view.position()[at] - first.position()[at]);
    format!("{x} {y} {z} {}", dot(axis, offset))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|at| a[at] * b[at]).sum()
}
