//! The shipped waters, number by number where it matters.

use super::*;
use crate::water::properties;

#[test]
fn a_bare_name_is_its_default_source() {
    let name = |name: &str| find(name).map(|preset| preset.name.as_str());
    assert_eq!(name("jerlov-3C"), Some("jerlov-3C/williamson2022"));
    assert_eq!(name("jerlov-9C"), Some("jerlov-9C/solonenko2015"));
    assert_eq!(name("jerlov-3C/solonenko2015"), Some("jerlov-3C/solonenko2015"));
    assert!(find("jerlov-4C").is_none() && find("jerlov").is_none());
}

#[test]
fn attenuation_is_absorption_plus_scattering() {
    let preset = find("jerlov-1C").unwrap();
    let expected = [0.366 + 0.412, 0.099 + 0.447, 0.159 + 0.435];
    assert_eq!(all_known(preset.beam_attenuation), Some(expected));
}

#[test]
fn waters_without_a_known_c_are_listed_but_not_rendered() {
    let preset = find("jerlov-5C/solonenko2015").unwrap();
    assert!(preset.unrenderable().is_some());
    assert_eq!(
        preset.absorption,
        [None, Some(0.117), Some(0.297)],
        "what is known is kept"
    );
    let can: Vec<_> = presets()
        .iter()
        .filter(|p| p.unrenderable().is_none())
        .map(|p| p.name.as_str())
        .collect();
    assert_eq!((presets().len(), can.len()), (59, 16), "{can:?}");
    assert!(
        can.iter()
            .all(|name| name.starts_with("jerlov-") || *name == "uuv-simulator")
    );
}

#[test]
fn names_are_used_once() {
    let names: std::collections::BTreeSet<_> = presets().iter().map(|preset| &preset.name).collect();
    assert_eq!(names.len(), presets().len());
}

#[test]
fn diffuse_attenuation_is_interpolated_at_the_wavelengths_of_the_preset() {
    let preset = find("jerlov-3C/williamson2022").unwrap();
    // 650 is tabulated; 555 is a tenth of the way from 550 (0.19) to 600 (0.33); 440 is between 400 and 450.
    let expected = [0.46, 0.19 + 0.1 * (0.33 - 0.19), 0.78 + 0.8 * (0.39 - 0.78)];
    let known = all_known(preset.diffuse_attenuation).unwrap();
    assert!(
        known.iter().zip(expected).all(|(k, e)| (k - e).abs() < 1e-12),
        "{known:?}"
    );
    assert!(preset.derived.contains(&"diffuse_attenuation_per_m"));
    assert!(
        !find("jerlov-3C/solonenko2015")
            .unwrap()
            .derived
            .contains(&"diffuse_attenuation_per_m")
    );
}

#[test]
fn transmissions_become_coefficients_and_red_is_mended() {
    let kd = |name: &str| find(name).unwrap().diffuse_attenuation;
    let rounded = |name: &str| kd(name).map(|v| (v.unwrap() * 1e4).round() / 1e4);
    assert_eq!(rounded("kd-5/uwcnn-printed"), [0.4005, 0.3147, 0.4005]);
    assert_eq!(rounded("kd-I/uwcnn-printed"), [0.2169, 0.0398, 0.0182]);
    assert_eq!(kd("kd-I/jerlov1968-kd")[0], Some(-f64::ln(0.850)));
    assert_eq!(kd("kd-II/jerlov1976"), [Some(0.40), Some(0.089), Some(0.068)]);
}

#[test]
fn a_k_d_given_as_beam_attenuation_is_known_by_its_numbers() {
    assert_eq!(
        diffuse_in_disguise([0.40, 0.089, 0.068]),
        Some("jerlov-II/solonenko2015")
    );
    assert_eq!(diffuse_in_disguise([0.4, 0.315, 0.4]), Some("kd-5/uwcnn-printed"));
    assert_eq!(diffuse_in_disguise([0.778, 0.546, 0.594]), None);
}

#[test]
fn what_follows_from_a_preset_is_marked_as_derived() {
    let preset = find("jerlov-1C").unwrap();
    let all = properties(preset);
    let b = all_known(preset.scattering).unwrap();
    assert_eq!(all.spread_rad_per_m, b.map(|b| Some(0.009 * b)));
    assert_eq!(
        (all.spread_offset_rad, all.backscatter_fraction),
        (Some(0.009), Some(0.0183))
    );
    assert_eq!(all.g[0], Some(0.366 + 0.05 * 0.412));
    let expected = [
        "beam_attenuation_per_m",
        "diffuse_attenuation_per_m",
        "veiling_light",
        "g_per_m",
        "spread_rad_per_m",
        "spread_offset_rad",
        "backscatter_fraction",
    ];
    assert_eq!(all.derived, expected);
    let bare = properties(find("nuc-2040/petzold1972").unwrap());
    assert_eq!(
        (bare.backscatter_fraction, bare.veiling_light, bare.g),
        (Some(0.020), None, [None; 3])
    );
}
