//! Settings of ORB-SLAM2 and ORB-SLAM3 for a sequence.

use spec::{Distortion, Intrinsics};

use crate::commands::dataset::export::formats::sequences::layout::format_real;
use crate::commands::dataset::export::formats::view::View;

pub(crate) const SETTINGS: &str = "orb_slam.yaml";

/// Baseline of the virtual right camera of RGB-D pictures, meters: that of the sensors of the TUM benchmark.
const VIRTUAL_BASELINE_M: f64 = 0.08;

/// Camera and frame rate of a sequence, and the parameters of the extractor that ORB-SLAM ships for its benchmarks. Numbers have a
/// decimal point, because ORB-SLAM rejects whole numbers as coefficients.
pub(crate) fn settings(view: &View, rate_hz: f64, depth_codes_per_m: f64) -> String {
    let Intrinsics { focal_px, cx, cy } = view.intrinsics;
    let Distortion { k1, k2, k3, p1, p2 } = view.distortion.unwrap_or_default();
    let (width, height) = (view.width, view.height);
    let bf = format_real(focal_px * view.baseline_m.unwrap_or(VIRTUAL_BASELINE_M));
    let [focal_px, cx, cy, k1, k2, k3, p1, p2] = [focal_px, cx, cy, k1, k2, k3, p1, p2].map(format_real);
    let [rate_hz, depth_codes_per_m] = [rate_hz, depth_codes_per_m].map(format_real);
    format!(
        "%YAML:1.0\n\
         Camera.type: \"PinHole\"\n\
         Camera.fx: {focal_px}\nCamera.fy: {focal_px}\nCamera.cx: {cx}\nCamera.cy: {cy}\n\
         Camera.k1: {k1}\nCamera.k2: {k2}\nCamera.p1: {p1}\nCamera.p2: {p2}\nCamera.k3: {k3}\n\
         Camera.width: {width}\nCamera.height: {height}\n\
         Camera.fps: {rate_hz}\nCamera.bf: {bf}\nCamera.RGB: 1\n\
         ThDepth: 40.0\nDepthMapFactor: {depth_codes_per_m}\n\
         ORBextractor.nFeatures: 1000\nORBextractor.scaleFactor: 1.2\nORBextractor.nLevels: 8\n\
         ORBextractor.iniThFAST: 20\nORBextractor.minThFAST: 7\n\
         Viewer.KeyFrameSize: 0.05\nViewer.KeyFrameLineWidth: 1.0\nViewer.GraphLineWidth: 0.9\nViewer.PointSize: 2.0\n\
         Viewer.CameraSize: 0.08\nViewer.CameraLineWidth: 3.0\n\
         Viewer.ViewpointX: 0.0\nViewer.ViewpointY: -0.7\nViewer.ViewpointZ: -1.8\nViewer.ViewpointF: 500.0\n"
    )
}
