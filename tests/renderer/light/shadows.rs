//! Shadows of lamps in whole frames.

use imaging::Rgb;
use serde_json::{Value, json};

use crate::common::{parse, render};

fn job(lamp: &Value, beside: &Value) -> Value {
    let mut lights = json!([{"kind": "spot", "position_m": [0.9, -0.3, 0.2], "intensity": [60, 60, 60],
                         "direction": [-0.3, 0.05, 1], "cone_deg": 60}]);
    let mut job = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 5},
        "camera": {"width": 96, "height": 64, "view": {"pitch_deg": -10, "height_m": 1.6, "distance_m": 3}},
        "water": {"optics": "jerlov-1C"},
        "metrics": [],
        "artifacts": ["rgb"]
    });
    for (fields, to) in [(lamp, &mut lights[0]), (beside, &mut job)] {
        for (name, value) in fields.as_object().unwrap() {
            to[name] = value.clone();
        }
    }
    job["lights"] = lights;
    job
}

fn picture(lamp: Value, beside: Value) -> (Rgb<u8>, Vec<Value>) {
    let rendered = render(&parse(&job(&lamp, &beside)));
    let rgb = crate::common::file(&rendered, "rgb");
    let picture = imaging::codec::decode_picture(rgb).unwrap().to_rgb8();
    let plane = |c: usize| {
        let codes = picture.pixels().map(|pixel| pixel[c]).collect();
        imaging::Plane::new(96, 64, codes).unwrap()
    };
    let lines = rendered.record.plan.as_array().unwrap().clone();
    (Rgb::new([plane(0), plane(1), plane(2)]).unwrap(), lines)
}

/// The share of samples that differ by more than a code, and whether the first is darker on average.
fn compare(one: &Rgb<u8>, other: &Rgb<u8>) -> (f64, f64) {
    let (mut changed, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (a, b) in one.planes().iter().zip(other.planes()) {
        for (a, b) in a.data().iter().zip(b.data()) {
            changed += f64::from(u8::from(a.abs_diff(*b) > 1));
            sum += f64::from(*b) - f64::from(*a);
            count += 1.0;
        }
    }
    (changed / count, sum / count)
}

fn line<'a>(lines: &'a [Value], stage: &str) -> Option<&'a Value> {
    lines.iter().find(|line| line["stage"] == stage)
}

#[test]
fn lamps_cast_shadows_that_soften_with_their_radius() {
    let of_radius = |radius_m: f64| picture(json!({"radius_m": radius_m}), json!({}));
    let (hard, lines) = of_radius(0.0);
    let found = line(&lines, "lamp_shadows").unwrap();
    assert_eq!((&found["variant"], &found["terms"]), (&json!("hard"), &json!(1)));
    assert!(found["note"].as_str().unwrap().contains("solids"), "{found}");
    let (soft, lines) = of_radius(0.1);
    assert_eq!(line(&lines, "lamp_shadows").unwrap()["variant"], "soft");
    let (changed, _) = compare(&soft, &hard);
    assert!(changed > 0.005, "{changed}");
}

#[test]
fn the_reference_has_the_same_shadows_but_at_their_edges() {
    let frame = |fidelity: Value| picture(json!({"radius_m": 0}), json!({"fidelity": fidelity}));
    let (fast, _) = frame(json!({"tolerance": 3e-4}));
    let (exact, lines) = frame(json!("reference"));
    let (changed, _) = compare(&fast, &exact);
    assert!(changed < 0.03, "{changed}");
    assert_eq!(line(&lines, "lamp_shadows").unwrap()["variant"], "reference");
}

#[test]
fn snow_in_shadow_is_as_dark_in_the_reference() {
    let frame = |fidelity: Value| {
        let snow = json!({"density_per_m3": 500, "radius_m": 0.004, "near_m": 0.3, "far_m": 3});
        let water = json!({"optics": "jerlov-1C", "snow": snow});
        picture(
            json!({"radius_m": 0}),
            json!({"water": water, "fidelity": fidelity}),
        )
        .0
    };
    let (changed, darker) = compare(&frame(json!({"tolerance": 3e-4})), &frame(json!("reference")));
    assert!(changed < 0.03 && darker.abs() < 0.1, "{changed} {darker}");
}

#[test]
fn a_lamp_before_open_water_needs_no_rays() {
    // Straight up into open water.
    let lamp = json!({"position_m": [0.3, 0, 0.3], "direction": [0, 0, 1]});
    let at = |height: f64| json!({"position_m": [0, -300, height], "target_m": [0.1, -300, height + 20.0]});
    let path = json!({"frames": 2, "frame": 0, "start": at(20.0), "end": at(21.0)});
    let (_, lines) = picture(lamp, json!({"camera": {"width": 96, "height": 64, "path": path}}));
    for stage in ["lamp_shadows", "glow_shadows"] {
        let traced = line(&lines, stage).filter(|line| line["cost_ms"].as_f64() > Some(0.0));
        assert!(traced.is_none(), "{traced:?}");
    }
}
