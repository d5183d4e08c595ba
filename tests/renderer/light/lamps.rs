//! Lamps of a job: lighting, records and refusals.

use imaging::codec::{Radiance, decode_radiance};
use serde_json::{Value, json};

use crate::common::{Files, file, parse_errors, render};

fn spot(direction: Value) -> Value {
    json!({"kind": "spot", "position_m": [0.3, 0.0, 0.0], "intensity": [8.0, 8.0, 8.0],
           "direction": direction, "cone_deg": 40.0})
}

/// Water with lamps; without `depth_m` and `daylight` it is night.
fn night() -> Value {
    json!({"optics": "jerlov-1C"})
}

/// The samples of an NPY artifact.
fn samples(bytes: &[u8]) -> Vec<f32> {
    let Radiance::Linear(layer) = decode_radiance(bytes).unwrap() else {
        panic!("a linear layer");
    };
    layer
        .into_planes()
        .into_iter()
        .flat_map(imaging::Plane::into_data)
        .collect()
}

fn brightest(bytes: &[u8]) -> f32 {
    samples(bytes).into_iter().fold(0.0, f32::max)
}

#[test]
fn by_night_only_the_lamps_are_seen() {
    let files = Files::new();
    let mut scene = files.scene("range.npy");
    scene["lighting"] = json!("water");
    let fields = |lights: Value| {
        json!({"scene": scene.clone(), "water": night(), "artifacts": ["rgb", "direct", "backscatter"], "lights": lights,
               "fidelity": {"tolerance": 0.01}})
    };
    let mut dark = fields(json!([]));
    dark["daylight"] = json!("none");
    let errors = parse_errors(&files.description(&dark));
    assert!(errors[0].message.contains("the scene is black"), "{errors:?}");
    let faint = {
        let mut lamp = spot(json!([0, 0, 1]));
        lamp["intensity"] = json!([1e-4, 1e-4, 1e-4]);
        render(&files.job(&fields(json!([lamp]))))
    };
    assert!(brightest(file(&faint, "direct")) < 1e-4);
    let lit = render(&files.job(&fields(json!([spot(json!([0, 0, 1]))]))));
    assert!(brightest(file(&lit, "direct")) > 1e-3);
    assert!(brightest(file(&lit, "backscatter")) > 1e-3, "the water glows");
    assert!(lit.record.timings_ms.contains_key("lamps"));
    let plan = lit.record.plan.as_array().unwrap();
    assert!(
        plan.iter()
            .any(|stage| stage["stage"] == "glow" && stage["variant"] == "quadrature")
    );
    let derived = lit.record.optics["derived"].as_array().unwrap();
    assert!(derived.contains(&json!("backscatter_fraction")));
    assert!(lit.record.warnings.is_empty(), "{:?}", lit.record.warnings);
}

/// Light of a spot next to the camera returns by scattering at more than a right angle, which is stronger with the phase function of
/// sea water.
#[test]
fn the_glow_is_brighter_where_it_rises_toward_the_back() {
    let files = Files::new();
    let frame = |phase: Value| {
        let mut optics = json!({"preset": "jerlov-1C"});
        if !phase.is_null() {
            optics["phase"] = phase;
        }
        let fields = json!({"water": {"optics": optics}, "artifacts": ["backscatter"],
                            "lights": [spot(json!([0, 0, 1]))]});
        render(&files.job(&fields))
    };
    let [absent, hg, ff] = [json!(null), json!("hg"), json!("ff")].map(frame);
    assert_eq!(file(&absent, "backscatter"), file(&ff, "backscatter"));
    let sum = |bytes: &[u8]| samples(bytes).into_iter().sum::<f32>();
    let more = sum(file(&ff, "backscatter")) / sum(file(&hg, "backscatter"));
    assert!((1.1..1.7).contains(&more), "{more}");
    let wrong = json!({"water": {"optics": {"preset": "jerlov-1C", "phase": "petzold"}}});
    let errors = parse_errors(&files.description(&wrong));
    assert_eq!(errors[0].pointer, "/water/optics/phase");
    assert_eq!(errors[0].allowed, ["ff", "hg"]);
}

#[test]
fn lamps_over_a_scene_without_range_are_skipped_with_a_warning() {
    let files = Files::new();
    let lights = json!([spot(json!([0, 0, 1]))]);
    let fields = json!({"scene": files.scene_without_range(), "lights": lights});
    assert_eq!(
        render(&files.stored_job(&fields)).record.warnings,
        ["the scene has no range: the lamps are skipped"]
    );
}

#[test]
fn the_reference_and_the_fast_form_give_the_same_picture() {
    let files = Files::new();
    let frame = |fidelity: Value| {
        let fields = json!({"water": {"optics": "jerlov-1C"}, "artifacts": ["backscatter"],
                            "lights": [spot(json!([0, 0, 1]))], "fidelity": fidelity});
        samples(file(&render(&files.job(&fields)), "backscatter"))
    };
    let (fast, exact) = (frame(json!({"tolerance": 1e-4})), frame(json!("reference")));
    let worst = fast
        .iter()
        .zip(&exact)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max);
    assert!(worst < 1.1e-4, "{worst}");
}

/// Without daylight there is no veil: the backscatter is the airlight of lamps.
#[test]
fn patches_of_turbidity_dim_and_brighten_the_glow() {
    let files = Files::new();
    let glow = |turbidity: Value, fidelity: Value| {
        let mut water = night();
        water["turbidity"] = turbidity;
        let fields = json!({"water": water, "artifacts": ["backscatter"],
                            "lights": [spot(json!([0, 0, 1]))], "fidelity": fidelity});
        samples(file(&render(&files.job(&fields)), "backscatter"))
    };
    let difference = |one: &[f32], other: &[f32]| {
        let pairs = one.iter().zip(other);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    let patches = json!({"contrast": 0.9, "scale_m": 0.5});
    let even = glow(
        json!({"contrast": 0.0, "scale_m": 0.5}),
        json!({"tolerance": 1e-4}),
    );
    let patchy = glow(patches.clone(), json!({"tolerance": 1e-4}));
    let most = even.iter().copied().fold(0.0, f32::max);
    assert!(difference(&even, &patchy) > 0.05 * most);
    let exact = glow(patches, json!("reference"));
    assert!(difference(&exact, &patchy) < 1.1e-4);
}

#[test]
fn bad_lamps_are_refused_together() {
    let files = Files::new();
    let bad = json!({"kind": "spot", "position_m": [0.0, 0.0, 2000.0], "intensity": [-1.0, 0.0, 0.0],
                     "direction": [0, 0, 0], "cone_deg": 120.0});
    let errors = parse_errors(&files.description(&json!({"lights": [bad]})));
    for pointer in [
        "/lights/0/position_m/2",
        "/lights/0/intensity/0",
        "/lights/0/cone_deg",
    ] {
        assert!(
            errors.iter().any(|error| error.pointer == pointer),
            "{pointer}: {errors:?}"
        );
    }
    let none =
        json!({"kind": "spot", "position_m": [0, 0, 0], "intensity": [1, 1, 1], "direction": [0, 0, 0]});
    let errors = parse_errors(&files.description(&json!({"lights": [none]})));
    assert_eq!(errors[0].pointer, "/lights/0/direction");
    let many = vec![spot(json!([0, 0, 1])); 1000];
    let errors = parse_errors(&files.description(&json!({"lights": many})));
    assert!(
        errors[0].message.contains("1000 elements; must be at most 64"),
        "{errors:?}"
    );
    let unknown = json!({"optics": {"beam_attenuation_per_m": [0.5, 0.5, 0.5], "veiling_light": [0, 0, 0]}});
    let fields = json!({"water": unknown, "lights": [spot(json!([0, 0, 1]))]});
    let errors = parse_errors(&files.description(&fields));
    assert!(
        errors[0].message.contains("scattering_per_m is missing"),
        "{errors:?}"
    );
}
