//! Waters are completed by the book, and contradictions are named all at once.

use super::*;

const FOCAL_PX: f64 = 600.0;

fn preset(name: &str) -> WaterRequest {
    WaterRequest {
        preset: Some(name.to_owned()),
        ..WaterRequest::default()
    }
}

fn coefficients() -> WaterRequest {
    WaterRequest {
        absorption: Some([0.3, 0.1, 0.05]),
        scattering: Some([0.2, 0.2, 0.3]),
        veiling_light: Some([0.1, 0.2, 0.3]),
        ..WaterRequest::default()
    }
}

fn scatter(model: ScatterModel) -> ScatterRequest {
    ScatterRequest {
        model,
        g: None,
        spread_px_per_m: None,
        spread_offset_px: None,
        source: ScatterSource::Radiance,
    }
}

fn close(actual: [f64; 3], expected: [f64; 3]) -> bool {
    actual.iter().zip(expected).all(|(a, e)| (a - e).abs() < 1e-12)
}

fn errors(request: &WaterRequest) -> Vec<String> {
    Water::validate(request).iter().map(ToString::to_string).collect()
}

#[test]
fn what_a_preset_lacks_is_derived_and_marked() {
    let water = Water::resolve(&preset("jerlov-1C"), FOCAL_PX).unwrap();
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
fn a_derived_veil_has_the_colour_of_daylight_at_depth_and_a_fixed_brightness() {
    let kd = [0.45, 0.1, 0.2];
    let request = WaterRequest {
        veiling_light: None,
        diffuse_attenuation: Some(kd),
        ..coefficients()
    };
    let at = |depth: f64| kd.map(|k| 0.3 * f64::exp(-(k - 0.1) * depth));
    assert!(close(
        Water::resolve(&request, FOCAL_PX).unwrap().veiling_light,
        at(5.0)
    ));
    let deep = WaterRequest {
        depth_m: Some(12.0),
        ambient: Ambient::Absolute,
        ..request.clone()
    };
    let water = Water::resolve(&deep, FOCAL_PX).unwrap();
    assert!(
        close(water.veiling_light, at(12.0)),
        "a derived veil is not darkened again"
    );
    assert!(close(water.radiance_gain, kd.map(|k| f64::exp(-k * 12.0))));
    let bright = WaterRequest {
        veil_gain: Some(0.6),
        ..request
    };
    assert!(close(
        Water::resolve(&bright, FOCAL_PX).unwrap().veiling_light,
        at(5.0).map(|v| 2.0 * v)
    ));
}

#[test]
fn a_given_veil_is_darkened_with_the_scene_in_absolute_light_only() {
    let kd = [0.45, 0.1, 0.2];
    let at = |ambient| {
        let request = WaterRequest {
            diffuse_attenuation: Some(kd),
            depth_m: Some(3.0),
            ambient,
            ..coefficients()
        };
        Water::resolve(&request, FOCAL_PX).unwrap()
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
    let request = WaterRequest {
        diffuse_attenuation: Some([0.2; 3]),
        ..coefficients()
    };
    let one = Water::resolve(&request, FOCAL_PX).unwrap();
    let two = Water::resolve(
        &WaterRequest {
            range_scale: 2.0,
            ..request
        },
        FOCAL_PX,
    )
    .unwrap();
    for ((name, one), (_, two)) in one.numbers().into_iter().zip(two.numbers()) {
        let factor = match name {
            "diffuse_attenuation_per_m" | "veiling_light" | "radiance_gain" | "spread_offset_px" => 1.0,
            _ => 2.0,
        };
        assert!(close(two.unwrap(), one.unwrap().map(|v| v * factor)), "{name}");
    }
}

#[test]
fn every_error_is_named_at_once_with_value_and_limit() {
    let wrong = WaterRequest {
        absorption: Some([-0.1, 0.1, f64::NAN]),
        scattering: Some([0.2, 0.2, 5000.0]),
        veiling_light: Some([0.1, -0.2, 0.3]),
        depth_m: Some(-3.0),
        range_scale: 0.0,
        scatter: Some(ScatterRequest {
            g: Some([0.1, 0.9, 0.1]),
            ..scatter(ScatterModel::Jaffe)
        }),
        ..WaterRequest::default()
    };
    let fields: Vec<_> = Water::validate(&wrong).iter().map(WaterError::field).collect();
    let expected = [
        "absorption_per_m",
        "absorption_per_m",
        "scattering_per_m",
        "veiling_light",
        "depth_m",
        "range_scale",
        "g_per_m",
    ];
    assert_eq!(fields[..6], expected[..6]);
    assert!(fields.contains(&"g_per_m"), "{fields:?}");
    let texts = errors(&wrong);
    assert!(texts.contains(&"absorption_per_m is -0.1 in channel R but must lie in 0..=1000".to_owned()));
    assert!(texts.contains(&"depth_m is -3 but must lie in 0..=12000".to_owned()));
}

#[test]
fn no_more_light_is_scattered_than_is_lost() {
    let scatter = Some(ScatterRequest {
        g: Some([0.1, 0.4, 0.1]),
        ..scatter(ScatterModel::Jaffe)
    });
    assert_eq!(
        errors(&WaterRequest {
            scatter,
            ..coefficients()
        }),
        ["g_per_m is 0.4 in channel G but at most the beam attenuation, 0.30000000000000004"]
    );
}

#[test]
fn attenuation_that_contradicts_its_parts_is_refused() {
    let request = WaterRequest {
        beam_attenuation: Some([0.5, 0.3, 0.4]),
        ..coefficients()
    };
    assert_eq!(
        errors(&request),
        ["beam_attenuation_per_m is 0.4 in channel B but absorption and scattering sum to 0.35"]
    );
    let part = WaterRequest {
        beam_attenuation: Some([0.5, 0.3, 0.04]),
        scattering: None,
        ..coefficients()
    };
    assert_eq!(
        errors(&part),
        ["absorption_per_m is 0.05 in channel B but at most the beam attenuation, 0.04"]
    );
}

#[test]
fn what_cannot_be_derived_must_be_given() {
    let fields = |request: &WaterRequest| -> Vec<_> {
        Water::validate(request).iter().map(WaterError::field).collect()
    };
    assert_eq!(
        fields(&WaterRequest::default()),
        ["beam_attenuation_per_m", "veiling_light"]
    );
    assert_eq!(
        fields(&preset("jerlov-5C/solonenko2015")),
        ["beam_attenuation_per_m"]
    );
    assert_eq!(fields(&preset("jerlov-4C")), ["preset"]);
    let deep = WaterRequest {
        ambient: Ambient::Absolute,
        ..coefficients()
    };
    assert_eq!(fields(&deep), ["depth_m"]);
    assert_eq!(
        fields(&WaterRequest {
            depth_m: Some(2.0),
            ..deep
        }),
        ["diffuse_attenuation_per_m"]
    );
    let bare = WaterRequest {
        beam_attenuation: Some([0.5; 3]),
        absorption: None,
        scattering: None,
        ..coefficients()
    };
    assert_eq!(
        fields(&WaterRequest {
            scatter: Some(scatter(ScatterModel::Jaffe)),
            ..bare.clone()
        }),
        ["g_per_m", "spread_px_per_m"]
    );
    assert_eq!(Water::resolve(&bare, FOCAL_PX).unwrap().scatter, Scatter::None);
}

#[test]
fn a_field_beside_a_preset_replaces_the_presets() {
    let request = WaterRequest {
        scattering: Some([1.0; 3]),
        ..preset("jerlov-1C")
    };
    let water = Water::resolve(&request, FOCAL_PX).unwrap();
    assert!(close(water.direct_attenuation, [1.366, 1.099, 1.159]));
    let request = WaterRequest {
        beam_attenuation: Some([0.7; 3]),
        ..preset("jerlov-1C")
    };
    let water = Water::resolve(&request, FOCAL_PX).unwrap();
    assert_eq!((water.direct_attenuation, water.absorption), ([0.7; 3], None));
}

#[test]
fn every_renderable_preset_resolves_without_more() {
    for preset in crate::preset::presets()
        .iter()
        .filter(|preset| preset.unrenderable().is_none())
    {
        let request = self::preset(&preset.name);
        assert!(Water::resolve(&request, FOCAL_PX).is_ok(), "{}", preset.name);
    }
}
