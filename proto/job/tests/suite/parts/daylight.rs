//! Daylight, water and scene lighting.

use serde_json::{Value, json};
use spec::{Daylight, SceneLighting, Sky};

use crate::common::{errors, job, job_with, only_error};

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
fn a_picture_has_an_up_and_a_procedural_scene_does_not() {
    let uploaded = |up: Value| json!({"scene": {"kind": "uploaded", "id": "scn_a"}, "camera": {"up": up}});
    let frame = job(&uploaded(json!([0, -3, 1]))).resolve(0).unwrap();
    assert_eq!(frame.camera.up, Some([0.0, -3.0, 1.0]));
    let none = errors(&uploaded(json!([0, 0, 0])));
    assert_eq!((none.len(), none[0].pointer.as_str()), (1, "/camera/up"));
    let known = only_error(json!({"camera": {"up": [0, -1, 0]}}));
    assert!(known.message.contains("needs an uploaded scene"), "{known:?}");
}
