//! Lists and sensors of a sequence as in the EuRoC benchmark (ASL layout). The body is the left camera.

use std::collections::BTreeMap;

use spec::{Distortion, Intrinsics};

use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::quaternion::quaternion;
use crate::commands::dataset::export::formats::sequences::layout::{depth_codes_per_m, format_real};
use crate::commands::dataset::export::formats::sequences::orb_slam::{SETTINGS, settings};
use crate::commands::dataset::export::formats::sequences::sequence::{Sequence, TextFile};
use crate::commands::dataset::export::formats::view::View;
use crate::commands::dataset::export::role::{RIGHT, Role};

const MAV: &str = "mav0";
const POSES: &str = "state_groundtruth_estimate0";
const POSES_HEAD: &str = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], \
    v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], \
    b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]";

/// `data.csv` of each sensor, `sensor.yaml` of each camera and of the poses, and times and settings for ORB-SLAM.
pub(super) fn texts(sequence: &Sequence) -> Vec<TextFile> {
    let Some(first) = sequence.frames.first() else {
        return Vec::new();
    };
    let mut texts = Vec::new();
    for (index, (kind, path)) in first.files.iter().enumerate() {
        let sensor = path.split('/').nth(1).unwrap_or_default();
        let list = sequence.list("#timestamp [ns],filename", |frame| {
            let name = frame.files[index].1.rsplit('/').next().unwrap_or_default();
            format!("{},{name}", frame.stamp_ns)
        });
        texts.push(TextFile::new(&[MAV, sensor], "data.csv", list));
        if index == 0 || Role::of_checked(kind) == Role::RightPicture {
            let camera = describe_camera(&first.view, sequence.rate_hz(), kind == RIGHT);
            texts.push(TextFile::new(&[MAV, sensor], "sensor.yaml", camera));
        }
    }
    texts.push(TextFile::new(&[MAV, POSES], "data.csv", list_poses(sequence)));
    let about = format!(
        "# Exact poses of the left camera.\nsensor_type: \"visual-inertial\"\n{}",
        describe_extrinsics(0.0)
    );
    texts.push(TextFile::new(&[MAV, POSES], "sensor.yaml", about));
    let times: String = sequence
        .frames
        .iter()
        .map(|frame| format!("{}\n", frame.stamp_ns))
        .collect();
    texts.push(TextFile::new(&[], "times.txt", times));
    let text = settings(&first.view, sequence.rate_hz(), depth_codes_per_m(Format::Euroc));
    texts.push(TextFile::new(&[], SETTINGS, text));
    texts
}

/// Poses with velocities by differences of neighboring positions. There is no IMU, so biases are 0.
fn list_poses(sequence: &Sequence) -> String {
    let velocities: BTreeMap<u64, [f64; 3]> = sequence
        .frames
        .iter()
        .map(|frame| frame.stamp_ns)
        .zip(sequence.velocities())
        .collect();
    sequence.list(POSES_HEAD, |frame| {
        let [w, x, y, z] = quaternion(frame.view.rotation());
        let [px, py, pz] = frame.view.position();
        let [vx, vy, vz] = velocities.get(&frame.stamp_ns).copied().unwrap_or_default();
        let stamp_ns = frame.stamp_ns;
        format!("{stamp_ns},{px},{py},{pz},{w},{x},{y},{z},{vx},{vy},{vz},0,0,0,0,0,0")
    })
}

fn describe_camera(view: &View, rate_hz: f64, is_right: bool) -> String {
    let Intrinsics { focal_px, cx, cy } = view.intrinsics;
    let Distortion { k1, k2, p1, p2, .. } = view.distortion.unwrap_or_default();
    let [focal_px, cx, cy, k1, k2, p1, p2, rate_hz] =
        [focal_px, cx, cy, k1, k2, p1, p2, rate_hz].map(format_real);
    let (width, height) = (view.width, view.height);
    let right_m = if is_right {
        view.baseline_m.unwrap_or_default()
    } else {
        0.0
    };
    format!(
        "sensor_type: camera\n{}rate_hz: {rate_hz}\nresolution: [{width}, {height}]\ncamera_model: pinhole\n\
         intrinsics: [{focal_px}, {focal_px}, {cx}, {cy}]\ndistortion_model: radial-tangential\n\
         distortion_coefficients: [{k1}, {k2}, {p1}, {p2}]\n",
        describe_extrinsics(right_m)
    )
}

/// The pose of a sensor to the right of the left camera, in the axes of that camera.
fn describe_extrinsics(right_m: f64) -> String {
    let right_m = format_real(right_m);
    format!(
        "T_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, {right_m}, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\n"
    )
}
