//! The right camera and disparity.

use serde_json::{Value, json};

use super::{contents, describe, linear, moved_path, picture, range, scene};
use crate::common::{engine_without_runtime, parse};
use renderer::{SceneSource, Slot};

const BASELINE_M: f64 = 0.2;

fn lamp(x: f64) -> Value {
    json!({"kind": "spot", "position_m": [x, -0.2, 0.0], "direction": [0.1, 0.1, 1.0], "cone_deg": 40, "intensity": [4, 4, 4]})
}

/// World-fixed and vehicle-fixed effects.
fn murky(lamp_x: f64) -> Value {
    json!({
        "water": {
            "optics": "jerlov-1C", "depth_m": 4,
            "snow": {"density_per_m3": 300, "far_m": 4},
            "turbidity": {"contrast": 0.4, "scale_m": 1},
            "sediment": {"cover": 0.5},
        },
        "daylight": {"cloud_cover": 0, "sun_elevation_deg": 50},
        "lights": [lamp(lamp_x)],
    })
}

fn extend(mut fields: Value, name: &str, value: Value) -> Value {
    fields[name] = value;
    fields
}

fn stereo(baseline_m: f64) -> Value {
    json!({"baseline_m": baseline_m})
}

#[test]
fn the_right_picture_is_that_of_a_moved_camera_with_the_same_lamps() {
    let path = moved_path(2, [BASELINE_M, 0.0, 0.0]);
    let still = json!({"frames": 2, "start": path["start"], "end": path["start"]});
    let pair = json!({"path": path, "stereo": stereo(BASELINE_M)});
    let left = contents(
        &describe(
            &pair,
            &extend(murky(0.3), "artifacts", json!(["rgb", "rgb_right"])),
        ),
        0,
    );
    // Frame 0 of a path that starts where the right camera is; lamps stay in the world.
    let moved = json!({"frames": 2, "start": path["end"], "end": still["start"]});
    let moved = contents(
        &describe(
            &json!({"path": moved}),
            &extend(murky(0.3 - BASELINE_M), "artifacts", json!(["rgb"])),
        ),
        0,
    );
    let (right, expected) = (picture(&left, "rgb_right"), picture(&moved, "rgb"));
    let differ = |other: &imaging::Rgb8| {
        let pairs = right.data().iter().zip(other.data());
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap()
    };
    // Poses differ in the last bits: one code.
    assert!(differ(expected) <= 1, "{}", differ(expected));
    assert!(differ(picture(&left, "rgb")) > 20);
}

#[test]
fn disparity_is_focal_length_times_baseline_over_depth() {
    let fields = json!({"artifacts": ["disparity", "range"]});
    let found = contents(&describe(&json!({"stereo": stereo(BASELINE_M)}), &fields), 0);
    let camera = scene(&found).intrinsics;
    let disparity = linear(&found, "disparity");
    let mut visible = 0;
    for (x, y) in (0..80).flat_map(|y| (0..120).map(move |x| (x, y))) {
        let [dx, dy, seen] = disparity.pixel(x, y);
        let meters = f64::from(range(&found).pixel(x, y));
        if !meters.is_finite() {
            assert!(dx.is_nan() && dy.is_nan() && seen == 0.0);
            continue;
        }
        let [u, v] = [
            (x as f64 - camera.cx) / camera.focal_px,
            (y as f64 - camera.cy) / camera.focal_px,
        ];
        let depth = meters / (1.0 + u * u + v * v).sqrt();
        assert!((f64::from(dx) - camera.focal_px * BASELINE_M / depth).abs() < 1e-4);
        assert!(dy.abs() < 1e-4);
        if x as f32 - dx < -0.5 {
            assert_eq!(seen, 0.0);
        }
        visible += u32::from(seen == 1.0);
    }
    assert!(visible > 5000, "{visible}");
}

#[test]
fn disparity_is_the_reversed_flow_of_a_sideways_path() {
    let path = moved_path(2, [BASELINE_M, 0.0, 0.0]);
    for lens in [
        json!({}),
        json!({"distortion": {"k1": -0.1}, "port": {"kind": "flat"}, "supersample": 2}),
    ] {
        let camera = extend(extend(lens, "path", path.clone()), "stereo", stereo(BASELINE_M));
        let found = contents(
            &describe(&camera, &json!({"artifacts": ["flow", "disparity"], "count": 2})),
            0,
        );
        let (flow, disparity) = (linear(&found, "flow"), linear(&found, "disparity"));
        let mut differing = 0;
        for (one, other) in flow.planes().iter().zip(disparity.planes()).take(2) {
            for (moved, shifted) in one.data().iter().zip(other.data()) {
                let sum = moved + shifted;
                assert!(moved.is_nan() && shifted.is_nan() || sum.abs() <= 1e-4);
            }
        }
        for (one, other) in flow.planes()[2].data().iter().zip(disparity.planes()[2].data()) {
            differing += u32::from(one != other);
        }
        assert!(differing < 3, "{differing}");
    }
}

#[test]
fn cameras_share_exposure_and_balance_but_not_noise() {
    let noisy = json!({"stereo": stereo(1e-6), "exposure": {"auto": {}}, "white_balance": "gray_world",
                       "sensor": {"light_level": 0.05}});
    let fields = json!({"artifacts": ["rgb", "rgb_right", "raw"], "water": {"optics": "jerlov-1C"}});
    let found = contents(&describe(&noisy, &fields), 0);
    let (left, right) = (picture(&found, "rgb"), picture(&found, "rgb_right"));
    let differing = left
        .data()
        .iter()
        .zip(right.data())
        .filter(|(a, b)| a != b)
        .count();
    assert!(differing * 2 > left.data().len(), "{differing}");
    // Noise of 30 codes in 10 000 pixels and 80 rows.
    let mean = |picture: &imaging::Rgb8| {
        picture.data().iter().map(|&code| f64::from(code)).sum::<f64>() / picture.data().len() as f64
    };
    assert!(
        (mean(left) - mean(right)).abs() < 1.5,
        "{} {}",
        mean(left),
        mean(right)
    );

    let clean = json!({"stereo": stereo(1e-6), "exposure": {"auto": {}}, "white_balance": "gray_world"});
    let found = contents(
        &describe(
            &clean,
            &json!({"artifacts": ["rgb", "rgb_right"], "water": {"optics": "jerlov-1C"}}),
        ),
        0,
    );
    let pairs = picture(&found, "rgb")
        .data()
        .iter()
        .zip(picture(&found, "rgb_right").data());
    assert!(pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap() <= 1);
}

#[test]
fn a_pair_does_not_change_the_left_picture_or_later_frames() {
    let job = |camera: Value, artifacts: Value| {
        parse(&describe(&camera, &extend(murky(0.0), "artifacts", artifacts)))
    };
    let pair = job(
        json!({"stereo": stereo(BASELINE_M)}),
        json!(["rgb", "rgb_right", "disparity"]),
    );
    let single = job(json!({}), json!(["rgb"]));
    let mut slot = Slot::new(&engine_without_runtime());
    let mut take = |job: &spec::Job| {
        let frame = job.resolve(0).unwrap();
        slot.render(&frame, &SceneSource::Local).unwrap().files
    };
    let (first, paired, again) = (take(&single), take(&pair), take(&single));
    assert_eq!(first[0].digest, paired[0].digest);
    assert_eq!(first, again);
    assert_eq!(take(&pair), paired);
}

#[test]
fn a_right_camera_in_a_surface_is_an_error_that_names_the_baseline() {
    let path = moved_path(2, [BASELINE_M, 0.0, 0.0]);
    let mut start = path["start"].clone();
    // The camera looks along the ground with its right side down.
    start["position_m"][2] = json!(0.06);
    start["target_m"][2] = json!(0.06);
    let mut end = path["end"].clone();
    end["position_m"][2] = json!(0.06);
    end["target_m"][2] = json!(0.06);
    let path = json!({"frames": 9, "start": start, "end": end, "sway_deg": 28, "sway_frames": 2.3});
    let camera = json!({"path": path, "stereo": stereo(10.0)});
    let job = parse(&describe(
        &camera,
        &json!({"artifacts": ["rgb_right"], "count": 9}),
    ));
    let mut slot = Slot::new(&engine_without_runtime());
    let errors = (0..9).filter_map(|index| {
        let frame = job.resolve(index).unwrap();
        slot.render(&frame, &SceneSource::Local).err()
    });
    let messages: Vec<String> = errors.map(|error| error.to_string()).collect();
    assert!(
        messages
            .iter()
            .any(|text| text.starts_with("`camera.stereo.baseline_m` is 10, which puts the camera")),
        "{messages:?}"
    );
}
