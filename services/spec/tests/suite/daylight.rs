//! Light from above: what must fit together.

use serde_json::{Value, json};
use spec::{SceneLight, SunShadow, SurfaceLight, VeilForm};

use crate::common::{errors, job, job_with, only_error, with};

/// A water in daylight with these fields beside.
fn water(from_above: Value, beside: Value) -> Value {
    let mut water = json!({"depth_m": 5, "from_above": from_above, "optics": {
        "absorption_per_m": [0.35, 0.08, 0.07], "scattering_per_m": [0.16, 0.18, 0.2]
    }});
    if let Value::Object(beside) = beside {
        for (name, value) in beside {
            water[name] = value;
        }
    }
    json!({"water": water})
}

#[test]
fn everything_but_depth_follows_from_a_and_b() {
    for veil in ["constant", "field", "physical"] {
        let beside = if veil == "constant" {
            json!({"optics": {"preset": "jerlov-1C"}})
        } else {
            json!({})
        };
        let job = job_with(water(json!({"veil": veil}), beside));
        let above = job.resolve(0).unwrap().water.from_above.unwrap();
        assert_eq!(above.veil == Some(VeilForm::Constant), veil == "constant");
    }
}

#[test]
fn what_light_from_above_needs_is_named() {
    let field = || json!({"veil": "field"});
    let cases = [
        (
            water(field(), json!({"depth_m": null})),
            "/water",
            "depth_m is missing",
        ),
        (
            water(
                field(),
                json!({"optics": {"beam_attenuation_per_m": [0.5, 0.3, 0.3], "veiling_light": [0.1, 0.2, 0.3]}}),
            ),
            "/water/optics",
            "diffuse",
        ),
        (
            water(
                field(),
                json!({"optics": {"beam_attenuation_per_m": [0.5, 0.3, 0.3],
                "diffuse_attenuation_per_m": [0.4, 0.1, 0.1]}}),
            ),
            "/water/from_above",
            "horizon is missing",
        ),
        (
            water(field(), json!({"optics": null})),
            "/water/from_above",
            "`water.optics`",
        ),
        (
            water(field(), json!({"holes": {"range_m": 9}})),
            "/water/holes",
            "background",
        ),
        (
            water(
                json!({"veil": "physical"}),
                json!({"optics": {"absorption_per_m": [0.35, 0.08, 0.07],
                "scattering_per_m": [0.16, 0.18, 0.2], "veiling_light": [0.1, 0.2, 0.3]}}),
            ),
            "/water/optics/veiling_light",
            "physical",
        ),
        (
            water(
                json!({"veil": "physical", "level": "exposed"}),
                json!({"ambient": "absolute"}),
            ),
            "/water/from_above/level",
            "ambient",
        ),
        (
            water(json!({"horizon": [2, 0.1, 0.1]}), json!({})),
            "/water/from_above/horizon/0",
            "1",
        ),
    ];
    for (mut fields, pointer, word) in cases {
        let Some(water) = fields["water"].as_object_mut() else {
            panic!("{fields}")
        };
        water.retain(|_, value| !value.is_null());
        // Neither K nor the horizon follows from c alone.
        let found = errors(&with(fields.clone()));
        let error = found.iter().find(|error| error.pointer == pointer);
        let error = error.unwrap_or_else(|| panic!("{fields}: {found:#?}"));
        assert_eq!(found.len(), if word == "diffuse" { 2 } else { 1 }, "{found:#?}");
        let text = format!("{error:?}");
        assert!(text.contains(word), "{text}");
    }
}

#[test]
fn a_given_horizon_needs_no_a_and_b() {
    let optics =
        json!({"beam_attenuation_per_m": [0.5, 0.3, 0.3], "diffuse_attenuation_per_m": [0.4, 0.1, 0.1]});
    job_with(water(
        json!({"veil": "field", "horizon": [0.01, 0.02, 0.02]}),
        json!({"optics": optics}),
    ));
}

#[test]
fn a_picture_says_where_up_is_and_a_procedural_scene_knows() {
    let uploaded = |up: Value| json!({"scene": {"kind": "uploaded", "id": "scn_a"}, "camera": {"up": up}});
    let frame = job(&uploaded(json!([0, -3, 1]))).resolve(0).unwrap();
    assert_eq!(frame.camera.up, Some([0.0, -3.0, 1.0]));
    let none = errors(&uploaded(json!([0, 0, 0])));
    assert_eq!((none.len(), none[0].pointer.as_str()), (1, "/camera/up"));
    let known = only_error(json!({"camera": {"up": [0, -1, 0]}}));
    assert!(known.message.contains("procedural"), "{known:?}");
}

#[test]
fn a_scene_of_reflectance_is_lit_from_above_and_a_picture_is_not_lit_twice() {
    let surfaces = |light: Value, water: Value| {
        let mut scene = json!({"kind": "procedural", "family": "structure", "seed": 1});
        if !light.is_null() {
            scene["light"] = light;
        }
        json!({"scene": scene, "water": water["water"]})
    };
    let normal = || json!({"surfaces": "normal", "sun_share": 0.5, "caustics": {"tile_m": 2}, "sun": {"azimuth_deg": 30}});
    let frame = job(&surfaces(json!("albedo"), water(normal(), json!({}))))
        .resolve(0)
        .unwrap();
    assert_eq!(frame.scene.light(), SceneLight::Albedo);
    let above = frame.water.from_above.unwrap();
    assert_eq!(above.surfaces(), SurfaceLight::Normal);
    let (sun, waves) = (above.sun.unwrap(), above.caustics.unwrap());
    assert_eq!(
        (sun.elevation_deg, sun.azimuth_deg, sun.shadow),
        (60.0, 30.0, SunShadow::Hard)
    );
    assert_eq!(
        (waves.tile_m, waves.cells, waves.slope, waves.fps),
        (2.0, 128, 0.12, None)
    );
    let cases = [
        (
            surfaces(Value::Null, water(normal(), json!({}))),
            "/water/from_above/surfaces",
            "lit already",
        ),
        (
            surfaces(
                Value::Null,
                water(json!({"surfaces": "depth"}), json!({"ambient": "exposed"})),
            ),
            "/water/ambient",
            "in its place",
        ),
        (
            surfaces(
                json!("albedo"),
                json!({"water": {"ambient": "exposed", "depth_m": 3, "optics": "jerlov-1C"}}),
            ),
            "/water/ambient",
            "reflectance",
        ),
        (
            surfaces(
                json!("albedo"),
                water(
                    json!({"surfaces": "normal", "caustics": {"cells": 100}}),
                    json!({}),
                ),
            ),
            "/water/from_above/caustics/cells",
            "power of two",
        ),
        (
            surfaces(
                json!("albedo"),
                water(
                    json!({"surfaces": "normal", "sun": {"elevation_deg": 4}}),
                    json!({}),
                ),
            ),
            "/water/from_above/sun/elevation_deg",
            "5",
        ),
    ];
    for (document, pointer, word) in cases {
        let found = errors(&document);
        let error = found.iter().find(|error| error.pointer == pointer);
        let error = error.unwrap_or_else(|| panic!("{document}: {found:#?}"));
        let text = format!("{error:?}");
        assert!(text.contains(word), "{text}");
    }
}

#[test]
fn what_changes_nothing_is_a_warning() {
    let warned = |above: Value, light: &str, beside: Value| {
        let mut fields = water(above, json!({}));
        fields["scene"] = json!({"kind": "procedural", "family": "structure", "light": light});
        for (name, value) in beside.as_object().unwrap() {
            fields[name] = value.clone();
        }
        job(&fields).warnings().to_vec()
    };
    let none: [String; 0] = [];
    let whole =
        json!({"surfaces": "normal", "sun_share": 0.5, "caustics": {}, "shafts": true, "ambient_rays": 4});
    assert_eq!(warned(whole, "albedo", json!({})), none);
    let cases = [
        (
            json!({"surfaces": "normal", "caustics": {}}),
            "albedo",
            "`sun_share` is 0",
        ),
        (
            json!({"surfaces": "normal", "sun_share": 0.5, "shafts": true}),
            "albedo",
            "`caustics`",
        ),
        (
            json!({"surfaces": "depth", "sun_share": 0.5}),
            "baked",
            "not \"normal\"",
        ),
        (
            json!({"surfaces": "depth", "ambient_rays": 8}),
            "baked",
            "not \"normal\"",
        ),
        (json!({"veil": "field"}), "albedo", "black"),
    ];
    for (above, light, word) in cases {
        let found = warned(above.clone(), light, json!({}));
        assert!(found.len() == 1 && found[0].contains(word), "{above}: {found:?}");
    }
    let lamp = json!([{"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]}]);
    let by_night = |water: Value| {
        let fields = json!({"lights": lamp, "water": water});
        job_with(fields).warnings().to_vec()
    };
    let optics = json!({"preset": "jerlov-1C"});
    let found = by_night(json!({"optics": optics}));
    assert!(found.len() == 1 && found[0].contains("[0, 0, 0]"), "{found:?}");
    assert_eq!(
        by_night(json!({"optics": {"preset": "jerlov-1C", "veiling_light": [0, 0, 0]}})),
        none
    );
    assert_eq!(
        by_night(json!({"optics": optics, "depth_m": 4, "from_above": {"veil": "field"}})),
        none
    );
}
