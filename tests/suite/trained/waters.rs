//! `fathom waters`: the description of every water.
#![allow(clippy::unwrap_used)]

use fathom_tests::run;
use serde_json::Value;

/// Fields of every water, known or not.
const FIELDS: [&str; 19] = [
    "name",
    "jerlov_type",
    "source",
    "licence",
    "caveats",
    "wavelength_nm",
    "absorption_per_m",
    "scattering_per_m",
    "beam_attenuation_per_m",
    "diffuse_attenuation_per_m",
    "veiling_light",
    "backscatter_fraction",
    "g_per_m",
    "spread_offset_rad",
    "spread_rad_per_m",
    "derived",
    "warnings",
    "defects",
    "unrenderable",
];

fn waters() -> Vec<Value> {
    let output = run(&["waters", "--json"]);
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).unwrap()
}

fn named<'a>(waters: &'a [Value], name: &str) -> &'a Value {
    waters.iter().find(|water| water["name"] == name).unwrap()
}

#[test]
fn every_water_says_all_that_is_known_of_it_and_no_more() {
    let waters = waters();
    assert!(waters.len() > 50, "{}", waters.len());
    for water in &waters {
        let name = water["name"].as_str().unwrap();
        let fields = water.as_object().unwrap();
        for field in FIELDS {
            assert!(fields.contains_key(field), "{name} says nothing of {field}");
        }
        for field in ["source", "licence"] {
            assert!(!water[field].as_str().unwrap().is_empty(), "{name}: {field}");
        }
        assert!(water["caveats"].is_array(), "{name}");
        for field in water["derived"].as_array().unwrap() {
            let field = field.as_str().unwrap();
            assert!(
                fields.get(field).is_some_and(|value| !value.is_null()),
                "{name} derives {field}, which it does not have"
            );
        }
        let known = |field: &str, channel: usize| water[field][channel].as_f64();
        for channel in 0..3 {
            let sum = known("absorption_per_m", channel).zip(known("scattering_per_m", channel));
            let beam = known("beam_attenuation_per_m", channel);
            if let (Some((a, b)), Some(c)) = (sum, beam) {
                assert!((a + b - c).abs() < 1e-9, "{name}: {a} + {b} is not {c}");
            }
            for field in FIELDS.into_iter().filter(|field| field.ends_with("_per_m")) {
                assert!(known(field, channel).is_none_or(|v| v >= 0.0), "{name}: {field}");
            }
        }
        let wavelengths: Vec<f64> = (0..3)
            .filter_map(|channel| known("wavelength_nm", channel))
            .collect();
        assert!(wavelengths.is_sorted_by(|a, b| a > b), "{name}: {wavelengths:?}");
        let renders = water["unrenderable"].is_null();
        let complete = (0..3).all(|channel| {
            known("beam_attenuation_per_m", channel).is_some() && known("veiling_light", channel).is_some()
        });
        assert!(!renders || complete, "{name} can be rendered without its numbers");
    }
}

#[test]
fn what_a_source_does_not_say_stays_unknown() {
    let waters = waters();
    let partly = named(&waters, "jerlov-5C/solonenko2015");
    assert_eq!(
        partly["absorption_per_m"],
        serde_json::json!([null, 0.117, 0.297])
    );
    assert!(partly["unrenderable"].is_string());
    let daylight = named(&waters, "kd-II/jerlov1976");
    assert_eq!(daylight["diffuse_attenuation_per_m"][2], 0.068);
    for field in ["absorption_per_m", "scattering_per_m", "beam_attenuation_per_m"] {
        assert!(daylight[field].is_null(), "{field}");
    }
    let measured = named(&waters, "jerlov-3C/williamson2022");
    assert_eq!(
        measured["wavelength_nm"],
        serde_json::json!([650.0, 555.0, 440.0])
    );
    assert_eq!(measured["unrenderable"], Value::Null);
}

#[test]
fn charts_belong_to_the_laboratory() {
    assert_eq!(run(&["waters", "--plot"]).status.code(), Some(2));
}
