//! Waters: consistency, and requirements on the optics.

use optics::own_water::parse_own;
use serde_json::{Value, json};
use spec::{
    ForwardScatter, Haze, HazeBlend, HazeSpace, HoleRule, Optics, ScatterModel, ScatterSource, Water,
};

use crate::common::{document_with, errors, job_with, only_error, vocabulary};

fn optics(optics: Value) -> Value {
    json!({"water": {"optics": optics}})
}

#[test]
fn every_field_reaches_the_frame() {
    let job = job_with(
        json!({"water": {"range_scale": 2, "depth_m": 3, "holes": "reject",
        "optics": {"absorption_per_m": [0.1, 0.2, 0.3], "scattering_per_m": [0.4, 0.5, 0.6],
            "beam_attenuation_per_m": [0.5, 0.7, 0.9], "backscatter_attenuation_per_m": [1, 2, 3],
            "diffuse_attenuation_per_m": [0.01, 0.02, 0.03], "veiling_light": [0.7, 0.8, 0.9], "veil_gain": 0.4,
            "forward_scatter": {"model": "jaffe", "g_per_m": [0.11, 0.12, 0.13], "spread_px_per_m": [4, 5, 6],
                "spread_offset_px": [7, 8, 9], "source": "direct"}}}}),
    );
    let expected = Water {
        range_scale: 2.0,
        depth_m: Some(3.0),
        holes: HoleRule::Reject,
        ..Optics {
            absorption_per_m: Some([0.1, 0.2, 0.3]),
            scattering_per_m: Some([0.4, 0.5, 0.6]),
            beam_attenuation_per_m: Some([0.5, 0.7, 0.9]),
            backscatter_attenuation_per_m: Some([1.0, 2.0, 3.0]),
            diffuse_attenuation_per_m: Some([0.01, 0.02, 0.03]),
            veiling_light: Some([0.7, 0.8, 0.9]),
            veil_gain: Some(0.4),
            forward_scatter: Some(ForwardScatter {
                model: ScatterModel::Jaffe,
                g_per_m: Some([0.11, 0.12, 0.13]),
                spread_px_per_m: Some([4.0, 5.0, 6.0]),
                spread_offset_px: Some([7.0, 8.0, 9.0]),
                source: ScatterSource::Direct,
            }),
            ..Optics::default()
        }
        .into()
    };
    assert_eq!(job.resolve(0).unwrap().water, expected);
}

#[test]
fn an_unrenderable_preset_reports_the_reason() {
    let error = only_error(optics(json!("clear-kd")));
    assert_eq!(
        (
            error.pointer.as_str(),
            error.message.contains("it has no beam attenuation")
        ),
        ("/water/optics", true)
    );
    assert_eq!(
        only_error(optics(json!({"preset": "clear-kd"}))).pointer,
        "/water/optics/preset"
    );
    assert_eq!(
        only_error(optics(json!({"choice": ["jerlov-1C", "clear-kd"]}))).pointer,
        "/water/optics/choice/1"
    );
}

const WATER: &str = r#"{"absorption_per_m": [0.1, 0.1, 0.1], "scattering_per_m": [0.2, 0.2, 0.2], "veiling_light": [0, 0, 0]}"#;

fn with_g(g: Value) -> Value {
    let mut water: Value = serde_json::from_str(WATER).unwrap();
    water["forward_scatter"] = json!({"g_per_m": g});
    optics(water)
}

#[test]
fn scatter_above_attenuation_is_refused_at_its_place() {
    let error = only_error(with_g(json!([0.1, 0.5, 0.1])));
    assert_eq!(error.pointer, "/water/optics/forward_scatter/g_per_m");
    assert!(error.message.contains("0.5"), "{}", error.message);
    job_with(with_g(json!([0.1, 0.3, 0.1])));
}

#[test]
fn the_ends_of_laws_are_tried_against_each_other() {
    let low = json!({"uniform": [0.1, 0.30001]});
    let error = only_error(with_g(json!([low, 0, 0])));
    assert_eq!(error.pointer, "/water/optics/forward_scatter/g_per_m");
    assert!(
        error
            .message
            .starts_with("a possible water of the distributions: "),
        "{}",
        error.message
    );
    job_with(with_g(json!([{"uniform": [0.1, 0.3]}, 0, 0])));
}

#[test]
fn many_laws_are_tried_one_at_a_time_and_the_pair_that_clashes_is_found() {
    let law = |a: f64, b: f64| json!({"uniform": [a, b]});
    let three = |a: f64, b: f64| json!([law(a, b), law(a, b), law(a, b)]);
    let water = |clash: f64| {
        json!({"water": {"range_scale": law(0.5, 2.0), "depth_m": law(0.0, 10.0), "optics": {"choice": ["jerlov-1C", {
            "beam_attenuation_per_m": three(0.3, 0.6), "backscatter_attenuation_per_m": three(0.1, 0.2),
            "diffuse_attenuation_per_m": three(0.1, 0.2), "veiling_light": three(0.0, 0.2), "veil_gain": law(0.1, 0.2),
            "forward_scatter": {"g_per_m": [law(0.0, 0.3), law(0.0, 0.3), law(0.0, clash)],
                "spread_px_per_m": three(0.0, 1.0)}}]}}})
    };
    job_with(water(0.3));
    let error = only_error(water(0.300_001));
    assert_eq!(error.pointer, "/water/optics/choice/1/forward_scatter/g_per_m");
}

#[test]
fn a_water_reports_its_missing_numbers() {
    let found = errors(&document_with(optics(json!({}))));
    let messages: Vec<_> = found.iter().map(|error| error.message.as_str()).collect();
    assert!(
        messages
            .iter()
            .any(|message| message.starts_with("beam_attenuation_per_m is missing")),
        "{messages:?}"
    );
    assert_eq!(found[0].pointer, "/water/optics");
}

#[test]
fn laws_of_fields_that_must_agree_are_refused() {
    let water = json!({"absorption_per_m": [{"int": [0, 1]}, 0, 0], "scattering_per_m": [0, 0, 0],
        "beam_attenuation_per_m": [{"int": [0, 1]}, 0, 0], "veiling_light": [0, 0, 0]});
    let error = only_error(optics(water));
    assert_eq!(error.pointer, "/water/optics/beam_attenuation_per_m");
}

#[test]
fn lights_keep_their_order() {
    let job = job_with(json!({"lights": [
        {"kind": "haze", "x": 0.1, "y": 0.2, "size": 0.3, "intensity": 0.4, "color": [1, 2, 3], "blend": "add",
            "space": "display"},
        {"kind": "point", "position_m": [0, 0, 1], "intensity": [1, 1, 1]},
        {"kind": "haze", "x": 1, "y": 1, "space": "display"}]}));
    let frame = job.resolve(0).unwrap();
    let first = Haze {
        x: 0.1,
        y: 0.2,
        size: 0.3,
        intensity: 0.4,
        color: [1.0, 2.0, 3.0],
        blend: HazeBlend::Add,
        space: HazeSpace::Display,
    };
    let second = Haze {
        x: 1.0,
        y: 1.0,
        size: 0.2,
        intensity: 1.0,
        color: [1.0; 3],
        blend: HazeBlend::Over,
        ..first
    };
    assert_eq!(frame.haze(), [first, second]);
    assert_eq!((frame.lights.len(), frame.lamp_count()), (3, 1));
}

#[test]
fn fields_that_vary_together_share_one_choice() {
    let coupled = json!({"choice": [
        {"absorption_per_m": [0.1, 0, 0], "scattering_per_m": [0, 0, 0], "beam_attenuation_per_m": [0.1, 0, 0],
            "veiling_light": [0, 0, 0]},
        {"absorption_per_m": [0.2, 0, 0], "scattering_per_m": [0, 0, 0], "beam_attenuation_per_m": [0.2, 0, 0],
            "veiling_light": [0, 0, 0]}]});
    job_with(optics(coupled));
    let axis = json!({"grid": [0.1, 0.2]});
    let crossed = json!({"absorption_per_m": [axis, 0, 0], "scattering_per_m": [0, 0, 0],
        "beam_attenuation_per_m": [axis, 0, 0], "veiling_light": [0, 0, 0]});
    assert_eq!(
        only_error(optics(crossed)).pointer,
        "/water/optics/beam_attenuation_per_m"
    );
}

#[test]
fn a_user_defined_water_is_expanded_to_numbers() {
    let short = job_with(optics(json!("quay")));
    let canonical: Value = serde_json::from_str(short.canonical()).unwrap();
    let written = json!({"name": "quay", "phase": "ff", "absorption_per_m": [0.4, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3],
        "diffuse_attenuation_per_m": [0.6, 0.4, 0.8], "backscatter_fraction": 0.02});
    assert_eq!(canonical["water"]["optics"], written);
    let mut forgetful = vocabulary(false);
    forgetful.waters.clear();
    let again = spec::Job::parse(short.canonical().as_bytes(), &forgetful).unwrap();
    assert_eq!(again.canonical(), short.canonical(), "no worker needs to know it");
    assert_eq!(
        again.resolve(0).unwrap().water.optics.unwrap().name.as_deref(),
        Some("quay")
    );
    let optics = short.resolve(0).unwrap().water.optics.unwrap();
    assert_eq!(
        (optics.preset, optics.scattering_per_m),
        (None, Some([1.0, 1.1, 1.3]))
    );
}

#[test]
fn overrides_replace_the_numbers_of_a_user_defined_water() {
    let resolve_optics = |fields: Value| job_with(optics(fields)).resolve(0).unwrap().water.optics.unwrap();
    let veiled =
        resolve_optics(json!({"preset": "quay", "veil_gain": 0.5, "absorption_per_m": [0.3, 0.1, 0.2]}));
    assert_eq!(
        (veiled.absorption_per_m, veiled.scattering_per_m),
        (Some([0.3, 0.1, 0.2]), Some([1.0, 1.1, 1.3]))
    );
    assert_eq!(veiled.name.as_deref(), Some("quay"));
    let whole = resolve_optics(json!({"preset": "quay", "beam_attenuation_per_m": [1, 1, 1]}));
    assert_eq!(
        (whole.absorption_per_m, whole.beam_attenuation_per_m),
        (None, Some([1.0; 3]))
    );
}

#[test]
fn a_choice_of_waters_may_contain_user_defined_ones_but_a_choice_of_presets_may_not() {
    let job = job_with(json!({"count": 40, "water": {"optics": {"choice": ["jerlov-1C", "quay"]}}}));
    let named = |i: u64| job.resolve(i).unwrap().water.optics.unwrap().name;
    assert!((0..40).any(|i| named(i).is_some()) && (0..40).any(|i| named(i).is_none()));
    let error = only_error(optics(json!({"preset": {"choice": ["jerlov-1C", "quay"]}})));
    assert_eq!(error.pointer, "/water/optics/preset/choice/1");
    assert!(
        error.message.contains("use a choice of optics"),
        "{}",
        error.message
    );
    let typo = only_error(optics(json!("qay")));
    assert_eq!(typo.did_you_mean.as_deref(), Some("quay"));
    let name = only_error(optics(json!({"name": "../x", "preset": "jerlov-1C"})));
    assert_eq!(name.pointer, "/water/optics/name");
}

fn quay() -> Value {
    json!({"name": "quay-2", "source": "a transmissometer", "wavelength_nm": [650, 550, 450],
        "absorption_per_m": [0.4, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3],
        "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]})
}

#[test]
fn a_good_water_is_read_and_its_canonical_form_reads_the_same() {
    let (water, preset) = parse_own(quay().to_string().as_bytes(), &[]).unwrap();
    assert_eq!(preset.name, "quay-2");
    assert!(
        !water.optics().contains_key("beam_attenuation_per_m"),
        "a and b stand for it"
    );
    let again = parse_own(water.description().as_bytes(), &[]).unwrap();
    assert_eq!(again, (water, preset));
}

#[test]
fn all_errors_of_a_water_are_listed_with_their_places() {
    let wrong = json!({"name": "a/b", "wavelength_nm": [450, 550, 650], "color": "green",
        "absorption_per_m": [-1, 0.2, 0.5], "scattering_per_m": [1.0, "x", 1.3], "backscatter_fraction": 3});
    let errors = parse_own(wrong.to_string().as_bytes(), &[]).unwrap_err().0;
    let pointers: Vec<_> = errors.iter().map(|error| error.pointer.as_str()).collect();
    let expected = [
        "/color",
        "/name",
        "/source",
        "/absorption_per_m/0",
        "/scattering_per_m/1",
        "/backscatter_fraction",
        "/wavelength_nm",
    ];
    assert_eq!(pointers, expected, "{errors:#?}");
    let mut missing = quay();
    missing.as_object_mut().unwrap().remove("scattering_per_m");
    let errors = parse_own(missing.to_string().as_bytes(), &[]).unwrap_err().0;
    assert_eq!(errors[0].pointer, "/beam_attenuation_per_m", "{errors:?}");
    for bytes in [
        &b"[]"[..],
        b"",
        b"{",
        b"null",
        b"{\"name\": \"a\", \"name\": \"b\"}",
    ] {
        assert!(parse_own(bytes, &[]).is_err());
    }
}

#[test]
fn a_water_that_fails_a_self_test_is_refused_with_the_test() {
    let mut thick = quay();
    thick["jerlov_type"] = json!("I");
    thick["absorption_per_m"] = json!([0.3, 0.96, 0.98]);
    let errors = parse_own(thick.to_string().as_bytes(), &[]).unwrap_err().0;
    assert!(
        errors
            .iter()
            .any(|error| error.message.contains("clear water attenuates")),
        "{errors:?}"
    );
}
