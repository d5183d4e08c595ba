use imaging::geometry::Intrinsics;
use spec::PhaseFunction;

use super::super::field::{Fields, Place};
use super::super::model::Bottom;
use super::super::model::Sun;
use super::super::sun::SunLight;
use super::super::wide::WideScattering;
use super::*;

fn coastal(depth: f64, share: f64, gaze: &Gaze) -> VeilOf {
    let sun = Sun {
        elevation_deg: 40.0,
        azimuth_deg: 70.0,
        casts_shadows: true,
    };
    let sun = (share > 0.0).then(|| SunLight::new(share, &sun));
    let place = Place {
        absorption: [0.179; 3],
        scattering: [0.219; 3],
        depth_m: depth,
        sun,
        scale: 1.0,
        bottom: (share > 0.5).then_some(Bottom {
            below_m: 3.0,
            reflectance: [0.4; 3],
        }),
    };
    let fields = Fields::new(&place, WideScattering::new(PhaseFunction::Ff, 0.0183));
    VeilOf {
        field: fields.channels[0],
        light: 0.7,
        depth: depth.max(SHALLOWEST),
        below: place.bottom.map_or(f64::INFINITY, |bottom| bottom.below_m),
        sun: sun.map(|sun| SunnyWater::seen_by(gaze, &sun)),
    }
}

#[test]
fn the_veil_grows_with_range_and_is_brighter_above_than_below() {
    let of = coastal(7.0, 0.0, &Gaze::unknown(9.0));
    let along = |rise: f64, range: Option<f64>| of.at([1.0, 0.0, 0.0], rise, range);
    assert_eq!(along(0.0, Some(0.0)), 0.0);
    assert!(along(0.0, Some(1.0)) < along(0.0, Some(3.0)) && along(0.0, Some(30.0)) <= along(0.0, None));
    assert!(along(0.5, Some(30.0)) > 2.0 * along(0.0, Some(30.0)));
    assert!(along(-0.5, Some(30.0)) < 0.7 * along(0.0, Some(30.0)));
}

#[test]
fn water_is_brightest_toward_the_sun() {
    let gaze = Gaze::unknown(9.0);
    let of = coastal(7.0, 0.8, &gaze);
    let [x, _, z] = of.sun.unwrap().toward;
    let level = x.hypot(z);
    let toward = of.at([x / level, 0.0, z / level], 0.0, Some(3.0));
    let away = of.at([-x / level, 0.0, -z / level], 0.0, Some(3.0));
    assert!(toward > 1.5 * away, "{toward} {away}");
}

#[test]
fn both_forms_agree_within_the_bound_at_every_place_of_a_wide_picture() {
    let camera = Intrinsics::centered(40.0, 97, 83);
    for up in [
        [0.0, -1.0, 0.0],
        [0.1, -0.7, 0.7],
        [0.0, 0.2, 1.0],
        [0.3, -0.2, -1.0],
    ] {
        let gaze = Gaze::new(camera, (97, 83), up);
        let range = Plane::from_fn(97, 83, |x, y| match (x + 3 * y) % 5 {
            0 => f32::NAN,
            1 => 1e-3,
            _ => 0.05 * (x * y) as f32 + 0.3,
        });
        for (share, depth) in [
            (0.0, 0.0),
            (0.6, 0.0),
            (0.0, 7.0),
            (0.6, 7.0),
            (0.9, 40.0),
            (0.3, 12_000.0),
        ] {
            let of = coastal(depth, share, &gaze);
            let mut fast = vec![0.0; 97 * 83];
            veil(&range, &of, &gaze, &mut fast);
            let exact = veil_reference(&range.map(|&z| f64::from(z)), &of, &gaze);
            let limit = of.rounding(gaze.rises, true);
            let brightest = of.brightest(gaze.rises, true);
            for (fast, exact) in fast.iter().zip(exact.data()) {
                assert!(
                    (f64::from(*fast) - exact).abs() <= limit.bound_sample(*exact),
                    "{up:?} {depth} {share}: {fast} {exact} beyond {limit:?}"
                );
                assert!(*exact <= brightest * (1.0 + 1e-12), "{exact} above {brightest}");
            }
        }
    }
}
