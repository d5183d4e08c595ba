//! Completion of waters, and reports of all contradictions together.

use spec::{ForwardScatter, Optics, ScatterModel};

use super::*;
use crate::medium::Ambient;

const FOCAL_PX: f64 = 600.0;

fn preset(name: &str) -> Optics {
    Optics {
        preset: Some(name.to_owned()),
        ..Optics::default()
    }
}

fn coefficients() -> Optics {
    Optics {
        absorption_per_m: Some([0.3, 0.1, 0.05]),
        scattering_per_m: Some([0.2, 0.2, 0.3]),
        veiling_light: Some([0.1, 0.2, 0.3]),
        ..Optics::default()
    }
}

fn close(actual: [f64; 3], expected: [f64; 3]) -> bool {
    actual.iter().zip(expected).all(|(a, e)| (a - e).abs() < 1e-12)
}

fn resolve(medium: impl Into<Medium>) -> Result<Water, Vec<WaterError>> {
    Water::resolve(&medium.into(), FOCAL_PX)
}

fn faults(medium: impl Into<Medium>) -> Vec<WaterError> {
    Water::validate(&medium.into(), false)
}

fn fields(medium: impl Into<Medium>) -> Vec<&'static str> {
    faults(medium).iter().map(WaterError::field).collect()
}

fn errors(medium: impl Into<Medium>) -> Vec<String> {
    faults(medium).iter().map(ToString::to_string).collect()
}

#[test]
fn what_a_preset_lacks_is_derived_and_marked() {
    let water = resolve(preset("jerlov-1C")).unwrap();
    assert_eq!(water.preset(), Some("jerlov-1C/williamson2022"));
    assert_eq!(
        water.derived(),
        ["veiling_light", "g_per_m", "spread_px_per_m", "spread_offset_px"]
    );
    let Scatter::Jaffe { g, spread, .. } = water.scatter else {
        panic!("no scatter")
    };
    let (a, b) = ([0.366, 0.099, 0.159], [0.412, 0.447, 0.435]);
    assert!(close(g, [0, 1, 2].map(|i| a[i] + 0.05 * b[i])));
    assert!(close(spread.offset_px, [0.009 * FOCAL_PX; 3]));
    assert!(close(spread.per_m, b.map(|b| 0.009 * b * FOCAL_PX)));
}

#[test]
fn a_derived_veil_has_the_color_of_daylight_at_depth_and_a_fixed_brightness() {
    let kd = [0.45, 0.1, 0.2];
    let request = Optics {
        veiling_light: None,
        diffuse_attenuation_per_m: Some(kd),
        ..coefficients()
    };
    let at = |depth: f64| kd.map(|k| 0.3 * f64::exp(-(k - 0.1) * depth));
    assert!(close(resolve(request.clone()).unwrap().veiling_light, at(5.0)));
    let deep = Medium {
        depth_m: Some(12.0),
        ambient: Ambient::Absolute,
        ..request.clone().into()
    };
    let water = resolve(deep).unwrap();
    assert!(
        close(water.veiling_light, at(12.0)),
        "a derived veil is not darkened again"
    );
    assert!(close(water.radiance_gain, kd.map(|k| f64::exp(-k * 12.0))));
    let bright = Optics {
        veil_gain: Some(0.6),
        ..request
    };
    assert!(close(
        resolve(bright).unwrap().veiling_light,
        at(5.0).map(|v| 2.0 * v)
    ));
}

#[test]
fn a_given_veil_is_darkened_with_the_scene_in_absolute_light_only() {
    let kd = [0.45, 0.1, 0.2];
    let at = |ambient| {
        let optics = Optics {
            diffuse_attenuation_per_m: Some(kd),
            ..coefficients()
        };
        let request = Medium {
            depth_m: Some(3.0),
            ambient,
            ..optics.into()
        };
        resolve(request).unwrap()
    };
    let decay = kd.map(|k| f64::exp(-k * 3.0));
    let (none, absolute, exposed) = (at(Ambient::None), at(Ambient::Absolute), at(Ambient::Exposed));
    assert_eq!(
        (none.radiance_gain, none.veiling_light),
        ([1.0; 3], [0.1, 0.2, 0.3])
    );
    assert!(close(absolute.radiance_gain, decay));
    assert!(close(
        absolute.veiling_light,
        [0.1 * decay[0], 0.2 * decay[1], 0.3 * decay[2]]
    ));
    assert!(close(exposed.radiance_gain, decay.map(|e| e / decay[1])));
    assert_eq!(exposed.veiling_light, [0.1, 0.2, 0.3]);
}

#[test]
fn range_scale_multiplies_what_acts_along_the_ray() {
    let request = Optics {
        diffuse_attenuation_per_m: Some([0.2; 3]),
        ..coefficients()
    };
    let one = resolve(request.clone()).unwrap();
    let two = Medium {
        range_scale: 2.0,
        ..request.into()
    };
    let two = resolve(two).unwrap();
    for ((name, one), (_, two)) in one.numbers().into_iter().zip(two.numbers()) {
        let factor = match name {
            "diffuse_attenuation_per_m" | "veiling_light" | "radiance_gain" | "spread_offset_px" => 1.0,
            _ => 2.0,
        };
        let Some(one) = one else {
            assert_eq!(two, None, "{name}");
            continue;
        };
        assert!(close(two.unwrap(), one.map(|v| v * factor)), "{name}");
    }
}

#[test]
fn every_error_is_named_at_once_with_value_and_limit() {
    let optics = Optics {
        absorption_per_m: Some([-0.1, 0.1, f64::NAN]),
        scattering_per_m: Some([0.2, 0.2, 5000.0]),
        veiling_light: Some([0.1, -0.2, 0.3]),
        forward_scatter: Some(ForwardScatter {
            g_per_m: Some([0.1, 0.9, 0.1]),
            ..ScatterModel::Jaffe.into()
        }),
        ..Optics::default()
    };
    let wrong = Medium {
        depth_m: Some(-3.0),
        range_scale: 0.0,
        ..optics.into()
    };
    let fields = fields(wrong.clone());
    let expected = [
        "absorption_per_m",
        "absorption_per_m",
        "scattering_per_m",
        "veiling_light",
        "range_scale",
        "depth_m",
        "g_per_m",
    ];
    assert_eq!(fields[..6], expected[..6]);
    assert!(fields.contains(&"g_per_m"), "{fields:?}");
    let texts = errors(wrong);
    assert!(texts.contains(&"absorption_per_m is -0.1 in R; must be 0..=1000".to_owned()));
    assert!(texts.contains(&"depth_m is -3; must be 0..=12000".to_owned()));
}

#[test]
fn no_more_light_is_scattered_than_is_lost() {
    let scatter = Some(ForwardScatter {
        g_per_m: Some([0.1, 0.4, 0.1]),
        ..ScatterModel::Jaffe.into()
    });
    assert_eq!(
        errors(Optics {
            forward_scatter: scatter,
            ..coefficients()
        }),
        ["g_per_m is 0.4 in channel G but at most the beam attenuation, 0.30000000000000004"]
    );
}

#[test]
fn attenuation_that_contradicts_its_parts_is_refused() {
    let request = Optics {
        beam_attenuation_per_m: Some([0.5, 0.3, 0.4]),
        ..coefficients()
    };
    assert_eq!(
        errors(request),
        ["beam_attenuation_per_m is 0.4 in channel B but absorption and scattering sum to 0.35"]
    );
    let part = Optics {
        beam_attenuation_per_m: Some([0.5, 0.3, 0.04]),
        scattering_per_m: None,
        ..coefficients()
    };
    assert_eq!(
        errors(part),
        ["absorption_per_m is 0.05 in channel B but at most the beam attenuation, 0.04"]
    );
}

#[test]
fn what_cannot_be_derived_must_be_given() {
    assert_eq!(
        fields(Optics::default()),
        ["beam_attenuation_per_m", "veiling_light"]
    );
    assert_eq!(
        fields(preset("jerlov-5C/solonenko2015")),
        ["beam_attenuation_per_m"]
    );
    assert_eq!(fields(preset("jerlov-4C")), ["preset"]);
    let deep = Medium {
        ambient: Ambient::Absolute,
        ..coefficients().into()
    };
    assert_eq!(fields(deep.clone()), ["depth_m"]);
    assert_eq!(
        fields(Medium {
            depth_m: Some(2.0),
            ..deep
        }),
        ["diffuse_attenuation_per_m"]
    );
    let bare = Optics {
        beam_attenuation_per_m: Some([0.5; 3]),
        absorption_per_m: None,
        scattering_per_m: None,
        ..coefficients()
    };
    assert_eq!(
        fields(Optics {
            forward_scatter: Some(ScatterModel::Jaffe.into()),
            ..bare.clone()
        }),
        ["g_per_m", "spread_px_per_m"]
    );
    assert_eq!(resolve(bare).unwrap().scatter, Scatter::None);
}

#[test]
fn a_field_beside_a_preset_replaces_the_presets() {
    let request = Optics {
        scattering_per_m: Some([1.0; 3]),
        ..preset("jerlov-1C")
    };
    let water = resolve(request).unwrap();
    assert!(close(water.direct_attenuation, [1.366, 1.099, 1.159]));
    let request = Optics {
        beam_attenuation_per_m: Some([0.7; 3]),
        ..preset("jerlov-1C")
    };
    let water = resolve(request).unwrap();
    assert_eq!((water.direct_attenuation, water.absorption), ([0.7; 3], None));
}

#[test]
fn every_renderable_preset_resolves_without_more() {
    for preset in crate::preset::presets()
        .iter()
        .filter(|preset| preset.unrenderable().is_none())
    {
        let request = self::preset(&preset.name);
        assert!(resolve(request).is_ok(), "{}", preset.name);
    }
}
