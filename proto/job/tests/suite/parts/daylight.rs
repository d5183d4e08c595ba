//! Daylight, water and scene lighting.

use serde_json::{Value, json};
use spec::{Daylight, SceneLighting, Sky};

use crate::common::{document_with, errors, job, job_with, only_error};

fn lamp() -> Value {
    json!([{"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]}])
}

#[test]
fn a_sky_has_defaults() {
    let sky = |daylight: Value| {
        let frame = job_with(json!({"water": {"optics": "jerlov-1C"}, "daylight": daylight})).resolve(0);
        frame.unwrap().daylight
    };
    assert_eq!(sky(json!({})), Daylight::Sky(Sky::default()));
    assert_eq!(sky(json!("auto")), Daylight::default());
    let low = Sky {
        sun_elevation_deg: 10.0,
        ..Sky::default()
    };
    assert_eq!(sky(json!({"sun_elevation_deg": 10})), Daylight::Sky(low));
}

#[test]
fn contradictions_of_daylight_are_refused() {
    let no_water = only_error(json!({"daylight": {}}));
    assert_eq!(no_water.pointer, "/daylight");
    assert!(
        no_water.message.contains("`water.optics`"),
        "{}",
        no_water.message
    );
    for field in [json!({"veiling_light": [0, 0.1, 0.1]}), json!({"veil_gain": 0.5})] {
        let mut optics = json!({"preset": "jerlov-1C"});
        let (name, value) = field.as_object().unwrap().iter().next().unwrap();
        optics[name] = value.clone();
        let error = only_error(json!({"daylight": {"cloud_cover": 1}, "water": {"optics": optics}}));
        assert_eq!(error.pointer, format!("/water/optics/{name}"));
        assert!(error.message.contains("a sky in `daylight`"), "{}", error.message);
    }
}

#[test]
fn a_dark_night_is_refused_unless_the_picture_contains_its_light() {
    let error = only_error(json!({"daylight": "none"}));
    assert_eq!(error.pointer, "/scene/lighting");
    assert!(error.message.contains("the scene is black"), "{}", error.message);
    job_with(json!({"daylight": "none", "lights": lamp()}));
    let in_air = json!({"kind": "procedural", "family": "structure", "lighting": "in_air"});
    let frame = job_with(json!({"daylight": "none", "scene": in_air}))
        .resolve(0)
        .unwrap();
    assert_eq!(frame.scene.lighting(), SceneLighting::InAir);
    job_with(json!({"daylight": {"choice": ["auto", "none"]}}));
    // An invalid lamp may still light the scene.
    let mut dim = lamp();
    dim[0]["radius_m"] = json!(7);
    let found = only_error(json!({"daylight": "none", "lights": {"choice": [dim]}}));
    assert_eq!(found.pointer, "/lights/choice/0/0/radius_m");
}

#[test]
fn a_night_has_no_sun_and_no_wind() {
    let found = errors(&document_with(json!({
        "daylight": "none", "lights": lamp(), "sun_elevation_deg": 30, "wind_m_per_s": 3,
    })));
    let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(pointers, ["/sun_elevation_deg", "/wind_m_per_s"], "{found:#?}");
    for error in found {
        assert!(error.message.contains("it is a field of `daylight`"), "{error:?}");
    }
    // A sky has no field that switches it off.
    for switch in ["none", "kind", "night"] {
        let found = errors(&document_with(json!({
            "daylight": {switch: "none", "sun_elevation_deg": 30}, "lights": lamp(), "water": {"optics": "jerlov-1C"},
        })));
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].pointer, format!("/daylight/{switch}"));
    }
}

#[test]
fn a_night_has_no_veil_in_any_frame() {
    let night = |daylight: Value, optics: Value| json!({"daylight": daylight, "lights": lamp(), "water": {"optics": optics}});
    let dim = json!({"preset": "jerlov-1C", "veil_gain": {"uniform": [0, 0.5]}});
    let bright = json!({"preset": "jerlov-1C", "veiling_light": [0, 0, {"choice": [0, 0.1]}]});
    for daylight in [json!("none"), json!({"choice": ["auto", "none"]})] {
        for (optics, field) in [(&dim, "veil_gain"), (&bright, "veiling_light")] {
            let error = only_error(night(daylight.clone(), optics.clone()));
            assert_eq!(error.pointer, format!("/water/optics/{field}"));
            assert!(error.message.contains("a night has no veil"), "{}", error.message);
            assert!(error.message.contains("or remove"), "{}", error.message);
            job_with(night(json!("auto"), optics.clone()));
        }
    }
    let chosen = json!({"choice": ["jerlov-3C", dim]});
    let error = only_error(night(json!("none"), chosen));
    assert_eq!(error.pointer, "/water/optics/choice/1/veil_gain");
    let dark = json!({"preset": "jerlov-1C", "veiling_light": [0, 0, 0], "veil_gain": 0});
    job_with(night(json!("none"), dark));
}

#[test]
fn black_frames_among_others_are_a_warning() {
    let warnings = |fields: Value| job_with(fields).warnings().join("; ");
    let lamps_or_none = json!({"choice": [[], lamp()]});
    let sometimes_night = json!({"choice": ["none", "auto"]});
    for fields in [
        json!({"daylight": "none", "lights": lamps_or_none}),
        json!({"daylight": sometimes_night}),
        json!({"daylight": sometimes_night, "lights": lamps_or_none}),
    ] {
        assert!(warnings(fields.clone()).contains("it is black"), "{fields}");
    }
    let in_air = json!({"kind": "procedural", "family": "structure", "lighting": "in_air"});
    for fields in [
        json!({"daylight": sometimes_night, "lights": lamp()}),
        json!({"daylight": "auto", "lights": lamps_or_none}),
        json!({"daylight": "none", "lights": lamps_or_none, "scene": in_air}),
    ] {
        assert_eq!(warnings(fields.clone()), "", "{fields}");
    }
}

#[test]
fn all_contradictions_of_a_place_are_reported_together() {
    let found = errors(&document_with(json!({
        "daylight": "none", "cloud_cover": 1, "lights": lamp(),
        "water": {"optics": {"preset": "jerlov-1C", "veil_gain": 1}, "depth_m": -1},
        "camera": {"path": {"frames": 2, "start": waypoint(-0.5), "end": waypoint(1.0)}},
    })));
    let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
    let expected = [
        "/cloud_cover",
        "/water/depth_m",
        "/camera/path/start/position_m/2",
        "/water/optics/veil_gain",
    ];
    assert_eq!(pointers, expected, "{found:#?}");
}

fn waypoint(height_m: f64) -> Value {
    json!({"position_m": [0, 0, height_m], "target_m": [0, 1, 1]})
}

#[test]
fn a_waypoint_is_above_the_bottom_in_every_frame() {
    let between =
        |start: Value, end: Value| json!({"camera": {"path": {"frames": 9, "start": start, "end": end}}});
    let error = only_error(between(waypoint(1.0), waypoint(-0.1)));
    assert_eq!(error.pointer, "/camera/path/end/position_m/2");
    assert!(
        error.message.contains("-0.1 m, below the bottom"),
        "{}",
        error.message
    );
    let mut drawn = waypoint(1.0);
    drawn["position_m"][2] = json!({"uniform": [-0.1, 4]});
    let error = only_error(between(drawn, waypoint(1.0)));
    assert_eq!(error.pointer, "/camera/path/start/position_m/2");
    let chosen = json!({"choice": [waypoint(2.0), waypoint(-2.0)]});
    let error = only_error(between(chosen, waypoint(1.0)));
    assert_eq!(error.pointer, "/camera/path/start/choice/1/position_m/2");
    job_with(between(waypoint(0.0), waypoint(1.0)));
}

#[test]
fn a_picture_has_an_up_and_a_procedural_scene_does_not() {
    let uploaded = |up: Value| json!({"scene": {"kind": "uploaded", "id": "scn_a"}, "camera": {"up": up}});
    let frame = job(&uploaded(json!([0, -3, 1]))).resolve(0).unwrap();
    assert_eq!(frame.camera.up, Some([0.0, -3.0, 1.0]));
    let none = errors(&uploaded(json!([0, 0, 0])));
    assert_eq!((none.len(), none[0].pointer.as_str()), (1, "/camera/up"));
    let known = only_error(json!({"camera": {"up": [0, -1, 0]}}));
    assert!(known.message.contains("needs an uploaded scene"), "{known:?}");
}
