//! The models that a description gets.
#![allow(clippy::unwrap_used)]

use optics::daylight::SurfaceLight;
use optics::medium::{Ambient, Kernels, Medium, Surroundings};
use optics::water::Water;
use spec::{Daylight, NamedDaylight, Optics, PhaseFunction, ScatterModel, Sky};

/// A still scene of reflectance without lamps, in daylight that is not described.
const DAY: Surroundings = Surroundings {
    daylight: Daylight::Named(NamedDaylight::Auto),
    has_lamps: false,
    is_reflectance: true,
    frames_per_s: None,
};
const LAMPS: Surroundings = Surroundings {
    has_lamps: true,
    ..DAY
};

fn coastal() -> Optics {
    Optics {
        absorption_per_m: Some([0.35, 0.08, 0.06]),
        scattering_per_m: Some([0.2, 0.22, 0.5]),
        ..Optics::default()
    }
}

fn choose(optics: Optics, surroundings: &Surroundings) -> Medium {
    Medium::choose(&optics.into(), surroundings).unwrap()
}

#[test]
fn a_plain_water_by_day_has_the_veil_of_a_sky_and_lit_surfaces() {
    let medium = choose(coastal(), &DAY);
    let daylight = medium.daylight.unwrap();
    assert_eq!(daylight.surfaces, SurfaceLight::Normal);
    assert_eq!(medium.depth_m, Some(5.0));
    assert_eq!((medium.kernels, medium.ambient), (Kernels::Two, Ambient::None));
    assert_eq!(medium.airlight_phase, PhaseFunction::Ff);
    assert!(Water::resolve(&medium, 500.0).is_ok());
}

#[test]
fn lamps_without_a_depth_shine_at_night() {
    let medium = choose(coastal(), &LAMPS);
    assert_eq!(medium.daylight, None);
    assert_eq!(medium.optics.veiling_light, Some([0.0; 3]));
    let water = spec::Water {
        depth_m: Some(12.0),
        ..coastal().into()
    };
    let medium = Medium::choose(&water, &LAMPS).unwrap();
    assert!(medium.daylight.is_some() && medium.depth_m == Some(12.0));
    let night = Surroundings {
        daylight: Daylight::Named(NamedDaylight::None),
        ..LAMPS
    };
    assert_eq!(Medium::choose(&water, &night).unwrap().daylight, None);
}

#[test]
fn a_given_veil_stays_unless_a_sky_is_described() {
    let given = Optics {
        veil_gain: Some(0.3),
        diffuse_attenuation_per_m: Some([0.45, 0.1, 0.2]),
        ..coastal()
    };
    let medium = choose(given.clone(), &DAY);
    assert_eq!((medium.daylight, medium.depth_m), (None, None));
    let sky = Surroundings {
        daylight: Daylight::Sky(Sky::default()),
        ..DAY
    };
    let errors = Water::validate(&choose(given, &sky), false);
    assert_eq!(
        errors.iter().map(|error| error.field()).collect::<Vec<_>>(),
        ["veil_gain"]
    );
}

#[test]
fn a_picture_that_is_lit_in_air_gets_the_color_of_its_depth() {
    let picture = Surroundings {
        is_reflectance: false,
        ..DAY
    };
    let medium = choose(coastal(), &picture);
    assert_eq!(medium.ambient, Ambient::Exposed);
    assert_eq!(medium.daylight.unwrap().surfaces, SurfaceLight::None);
}

#[test]
fn a_published_scatter_keeps_its_only_kernel() {
    let optics = Optics {
        forward_scatter: Some(ScatterModel::Jaffe.into()),
        ..coastal()
    };
    assert_eq!(choose(optics, &DAY).kernels, Kernels::One);
    let attenuation_alone = Optics {
        beam_attenuation_per_m: Some([0.5; 3]),
        veiling_light: Some([0.1; 3]),
        ..Optics::default()
    };
    assert_eq!(choose(attenuation_alone, &DAY).kernels, Kernels::One);
    assert_eq!(Medium::choose(&spec::Water::default(), &DAY), None);
}

#[test]
fn an_overcast_sky_has_neither_sun_nor_caustics() {
    let sky = |cloud_cover| Surroundings {
        daylight: Daylight::Sky(Sky {
            cloud_cover,
            ..Sky::default()
        }),
        ..DAY
    };
    let overcast = choose(coastal(), &sky(1.0)).daylight.unwrap();
    assert_eq!((overcast.sun_share, overcast.caustics), (0.0, None));
    let clear = choose(coastal(), &sky(0.0)).daylight.unwrap();
    assert!(clear.sun_share > 0.7 && clear.caustics.is_some() && clear.shafts);
}
