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

#[test]
fn snow_and_mud_behind_things_are_dark_and_snow_is_so_in_the_reference_too() {
    let of = |name: &str, hung: &Value, shadow: &str, fidelity: Value| {
        let mut water = job(&json!({}), &json!({}))["water"].clone();
        water[name] = hung.clone();
        picture(
            json!({"shadow": shadow}),
            json!({"water": water, "fidelity": fidelity}),
        )
        .0
    };
    let fine = json!({"tolerance": 3e-4});
    let bare = |shadow: &str| picture(json!({"shadow": shadow}), json!({})).0;
    let (_, lost) = compare(&bare("hard"), &bare("none"));
    let mud = json!({"cover": 1, "height_m": 4, "extinction_per_m": 3});
    let snow = json!({"density_per_m3": 500, "radius_m": 0.004, "near_m": 0.3, "far_m": 3});
    // Mud hides all surfaces, and most of it hangs before what casts shadows.
    for (name, hung, least) in [("sediment", &mud, 0.1), ("snow", &snow, 0.5)] {
        let [open, hard] = ["none", "hard"].map(|shadow| of(name, hung, shadow, fine.clone()));
        let (_, darker) = compare(&hard, &open);
        assert!(darker > least * lost, "{name}: {darker} of {lost}");
    }
    let exact = of("snow", &snow, "hard", json!({"variant": "reference"}));
    let (changed, darker) = compare(&of("snow", &snow, "hard", fine), &exact);
    assert!(changed < 0.03 && darker.abs() < 0.1, "{changed} {darker}");
}

#[test]
fn a_lamp_that_nothing_stands_before_needs_no_rays() {
    // Straight up into open water.
    let lamp =
        json!({"shadow": "hard", "glow_shadow": true, "position_m": [0.3, 0, 0.3], "direction": [0, 0, 1]});
    let at = |height: f64| json!({"position_m": [0, -300, height], "target_m": [0.1, -300, height + 20.0]});
    let path = json!({"frames": 2, "frame": 0, "start": at(20.0), "end": at(21.0)});
    let up = json!({"camera": {"width": 96, "height": 64, "path": path}});
    let (open, _) = picture(
        json!({"position_m": [0.3, 0, 0.3], "direction": [0, 0, 1]}),
        up.clone(),
    );
    let (cast, lines) = picture(lamp, up);
    let found = line(&lines, "glow_shadows").unwrap();
    assert_eq!(
        (&found["variant"], &found["terms"]),
        (&json!("skip"), &json!(0)),
        "{found}"
    );
    assert!(
        found["note"]
            .as_str()
            .unwrap()
            .contains("nothing can occlude them")
    );
    assert_eq!(found["cost_ms"], json!(0.0));
    assert_eq!(cast, open);
}
