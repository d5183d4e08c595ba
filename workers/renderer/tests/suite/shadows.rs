//! Shadows of lamps in whole frames.

use imaging::Rgb;
use serde_json::{Value, json};

use crate::common::{parse, render};

fn job(lamp: &Value, beside: &Value) -> Value {
    let mut lights = json!([{"kind": "spot", "position_m": [0.9, -0.3, 0.2], "intensity": [60, 60, 60],
                         "direction": [-0.3, 0.05, 1], "cone_deg": 60}]);
    let mut job = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 5},
        "camera": {"width": 96, "height": 64},
        "water": {"optics": {"preset": "jerlov-1C", "veil_gain": 0.0}, "depth_m": 200, "ambient": "absolute"},
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
fn things_cut_off_the_light_of_a_lamp_and_the_plan_says_by_what() {
    let (open, lines) = picture(json!({}), json!({}));
    assert!(line(&lines, "lamp_shadows").is_none() && line(&lines, "glow_shadows").is_none());
    let (none, _) = picture(json!({"shadow": "none"}), json!({}));
    assert_eq!(open, none);
    let (hard, lines) = picture(json!({"shadow": "hard"}), json!({}));
    let (changed, darker) = compare(&hard, &open);
    assert!(changed > 0.02 && darker > 0.1, "{changed} {darker}");
    let found = line(&lines, "lamp_shadows").unwrap();
    assert_eq!((&found["variant"], &found["terms"]), (&json!("hard"), &json!(1)));
    assert!(found["note"].as_str().unwrap().contains("solids"), "{found}");
    let soft = json!({"shadow": "soft", "radius_m": 0.1, "glow_shadow": true});
    let (glow, lines) = picture(soft, json!({"rays": "screen"}));
    assert!(compare(&glow, &open).1 > 0.1);
    assert_eq!(line(&lines, "lamp_shadows").unwrap()["variant"], "soft");
    let found = line(&lines, "glow_shadows").unwrap();
    assert!(found["note"].as_str().unwrap().contains("range image"), "{found}");
}

#[test]
fn the_reference_has_the_same_shadows_but_at_their_edges() {
    for multiple in ["none", "quasi_single"] {
        let lamp = json!({"shadow": "hard", "glow_shadow": true});
        let mut beside = json!({"fidelity": {"tolerance": 3e-4}});
        let mut water = job(&json!({}), &json!({}))["water"].clone();
        water["multiple"] = json!(multiple);
        beside["water"] = water;
        let (fast, _) = picture(lamp.clone(), beside.clone());
        beside["fidelity"] = json!({"variant": "reference"});
        let (exact, lines) = picture(lamp, beside);
        let (changed, _) = compare(&fast, &exact);
        assert!(changed < 0.03, "{multiple}: {changed}");
        assert_eq!(line(&lines, "lamp_shadows").unwrap()["variant"], "reference");
    }
}
