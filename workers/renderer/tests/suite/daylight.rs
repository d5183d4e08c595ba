//! Light from above in whole frames: what the record says, and what changes.

use serde_json::{Value, json};

use crate::common::{file, parse, render};

fn job(from_above: &Value) -> Value {
    json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 96, "height": 64},
        "water": {"depth_m": 6, "optics": "jerlov-1C", "from_above": from_above},
        "metrics": [],
        "artifacts": ["rgb"]
    })
}

/// Mean code of the rows of a picture from one to another.
fn mean(bytes: &[u8], rows: std::ops::Range<usize>) -> f64 {
    let picture = imaging::codec::decode_picture(bytes).unwrap().to_rgb8();
    let codes: Vec<f64> = picture
        .pixels()
        .skip(96 * rows.start)
        .take(96 * rows.len())
        .flatten()
        .map(f64::from)
        .collect();
    codes.iter().sum::<f64>() / codes.len() as f64
}

#[test]
fn open_water_brightens_towards_the_surface_and_the_record_says_why() {
    let constant = render(&parse(&job(&json!({"veil": "constant"}))));
    let field = render(&parse(&job(&json!({"veil": "field"}))));
    let slope = |rendered| mean(file(rendered, "rgb"), 0..10) - mean(file(rendered, "rgb"), 54..64);
    assert!(
        slope(&field) > slope(&constant) + 5.0,
        "{} {}",
        slope(&field),
        slope(&constant)
    );
    let record = &field.record;
    for name in ["horizon", "p", "q"] {
        assert!(
            record.optics[name]
                .as_array()
                .is_some_and(|numbers| numbers.len() == 3),
            "{name}"
        );
        assert!(
            record.optics["derived"]
                .as_array()
                .unwrap()
                .contains(&json!(name)),
            "{name}"
        );
    }
    let lines = record.plan.as_array().unwrap();
    let veil = lines.iter().find(|line| line["stage"] == "veil").unwrap();
    assert_eq!(veil["variant"], "by_direction");
    assert!(
        veil["bound"].as_f64().unwrap() > 0.0 && veil["cost_ms"].as_f64().unwrap() >= 0.0,
        "{veil}"
    );
    assert!(veil["model_error"].is_string());
    let other = constant.record.plan.as_array().unwrap();
    assert!(other.iter().all(|line| line["stage"] != "veil"));
}

#[test]
fn a_physical_veil_needs_none_and_is_darker_than_the_convention() {
    let field = render(&parse(&job(&json!({"veil": "field"}))));
    let physical = render(&parse(&job(&json!({"veil": "physical"}))));
    let light = |rendered: &renderer::Rendered| rendered.record.optics["veiling_light"][2].as_f64().unwrap();
    assert!(light(&physical) < 0.3 * light(&field), "{}", light(&physical));
    assert_ne!(file(&field, "rgb"), file(&physical, "rgb"));
}
