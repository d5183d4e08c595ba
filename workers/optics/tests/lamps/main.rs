//! Lamps: the fast form against the f64 reference, and properties of their light.
#![allow(clippy::unwrap_used)]

mod attack;
mod bounds;
mod errors;
mod patches;
mod shadows;

use errors::{peak, worst};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use optics::lamp::{self, GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, MOST_NODES, REFERENCE_NODES};

/// f32 arithmetic in angles and paths, as a share of the frame's peak: some hundred roundings of 6e-8.
const ROUNDING: f64 = 1e-5;
const SIZES: [(usize, usize); 5] = [(1, 1), (3, 2), (17, 13), (64, 5), (131, 37)];

/// Next to the camera, behind it, in view, beyond a wall, in the camera, and spots of both kinds.
fn lamps() -> Vec<(&'static str, Lamp)> {
    let light = [1.0, 0.8, 0.6];
    let spot = |place, direction, cone| Lamp::spot(place, light, direction, cone).unwrap();
    vec![
        ("beside", Lamp::point([-0.3, 0.2, 0.0], light).unwrap()),
        ("far beside", Lamp::point([2.0, -1.0, 0.5], light).unwrap()),
        ("behind", Lamp::point([0.1, 0.1, -0.6], light).unwrap()),
        ("in view", Lamp::point([0.4, 0.1, 1.5], light).unwrap()),
        ("behind a wall", Lamp::point([0.2, 0.0, 50.0], light).unwrap()),
        ("in the camera", Lamp::point([0.0; 3], light).unwrap()),
        ("spot ahead", spot([0.4, 0.0, 0.0], [-0.1, 0.0, 1.0], 25.0)),
        ("wide spot", spot([-0.4, 0.3, 0.1], [0.3, 0.0, 0.7], 80.0)),
        (
            "spot at the camera",
            spot([0.2, 0.1, 3.0], [-0.1, 0.0, -1.0], 30.0),
        ),
        ("spot across", spot([-1.0, 0.0, 2.0], [1.0, 0.05, 0.0], 15.0)),
        ("spot away", spot([0.0, 0.0, -0.5], [0.0, 0.0, -1.0], 40.0)),
    ]
}

const FORWARD: GlowPhase = GlowPhase {
    asymmetry: 0.919,
    rise: 0.0,
};
const ABSORPTION: [f64; 3] = [0.35, 0.08, 0.06];

fn lighting(lamps: Vec<Lamp>, (width, height): (usize, usize), phase: GlowPhase) -> Lighting {
    let scattering = [0.2, 0.22, 0.25];
    Lighting {
        lamps,
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(0.7 * width as f64, width, height),
        attenuation: [0, 1, 2].map(|i| ABSORPTION[i] + scattering[i]),
        scattering,
        absorption: None,
        phase,
        patches: None,
    }
}

/// A slope with a step, a hole and an open corner.
fn range(width: usize, height: usize) -> Plane<f32> {
    Plane::from_fn(width, height, |x, y| match (x, y) {
        (0, 0) => f32::INFINITY,
        (2, 1) => f32::NAN,
        _ if x > width / 2 => 0.8 + 0.01 * y as f32,
        _ => 2.0 + 0.05 * x as f32 + 0.1 * y as f32,
    })
}

/// Phase functions, and whether multiple scattering is modeled.
fn phases() -> Vec<(GlowPhase, bool)> {
    let even = [
        (-0.3, true),
        (0.0, false),
        (0.7, false),
        (0.919, false),
        (0.98, true),
    ];
    let rising = [(0.0183, true), (0.2, false)];
    let even = even.map(|(g, multiple)| (GlowPhase::henyey_greenstein(g), multiple));
    let rising = rising.map(|(fraction, multiple)| (GlowPhase::fournier_forand(fraction), multiple));
    even.into_iter().chain(rising).collect()
}

#[test]
fn airlight_stays_within_its_tolerance_of_the_reference() {
    for size in SIZES {
        let range = range(size.0, size.1);
        let exact_range = range.map(|&z| f64::from(z));
        for (phase, multiple) in phases() {
            let all = lamps();
            let mut cases: Vec<(&str, Vec<Lamp>)> =
                all.iter().map(|&(name, lamp)| (name, vec![lamp])).collect();
            cases.push(("all", all.into_iter().map(|(_, lamp)| lamp).collect()));
            // The reference of multiple scattering is slow.
            let also_multiple = multiple && size.0 < 100;
            let both = cases.into_iter().flat_map(|case| {
                let multiple = also_multiple.then(|| (case.clone(), true));
                [(case, false)].into_iter().chain(multiple)
            });
            for ((name, lamps), multiple) in both {
                let mut lighting = lighting(lamps, size, phase);
                lighting.absorption = multiple.then_some(ABSORPTION);
                let exact = lamp::airlight_reference(&exact_range, &lighting, REFERENCE_NODES);
                for tolerance in [1e-2, 3e-4, 1e-5] {
                    let fast = lamp::airlight(&range, &lighting, tolerance);
                    let error = worst(&fast.light, &exact);
                    let allowed = tolerance.max(fast.left) + fast.rounding.min(ROUNDING * peak(&exact));
                    assert!(
                        error <= allowed,
                        "{name}, {multiple}, {phase:?}, {size:?}, tolerance {tolerance:e}: {error:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn light_on_surfaces_agrees_with_the_reference() {
    for size in SIZES {
        let range = range(size.0, size.1);
        let mut lighting = lighting(lamps().into_iter().map(|(_, lamp)| lamp).collect(), size, FORWARD);
        let normals = lamp::normals_of(&range, &lighting.camera);
        for absorption in [None, Some(ABSORPTION)] {
            lighting.absorption = absorption;
            let exact = lamp::irradiance_reference(&range.map(|&z| f64::from(z)), &normals, &lighting);
            let fast = lamp::irradiance(&range, &normals, &lighting);
            let error = worst(&fast.light, &exact);
            assert!(
                error <= fast.rounding,
                "{size:?}: {error:e} above {:e}",
                fast.rounding
            );
        }
    }
}

/// A wall at 2 m, a lamp next to the camera: 1/r² and the path there and back, as a closed formula.
#[test]
fn a_wall_is_lit_by_the_square_of_the_distance_and_both_ways_through_the_water() {
    let mut lighting = lighting(
        vec![Lamp::point([0.0; 3], [4.0, 4.0, 4.0]).unwrap()],
        (5, 5),
        FORWARD,
    );
    lighting.camera.focal_px = 1e6;
    let range = Plane::filled(5, 5, 2.0f32);
    let normals = lamp::normals_of(&range, &lighting.camera);
    let light = lamp::irradiance(&range, &normals, &lighting).light;
    let expected = [0, 1, 2].map(|i| (-2.0 * lighting.attenuation[i]).exp());
    for (got, expected) in light.pixel(2, 2).into_iter().zip(expected) {
        assert!((f64::from(got) - expected).abs() < 1e-4, "{got} for {expected}");
    }
    let radiance = Rgb::from_fn(5, 5, |_, _| [0.5f32; 3]);
    let lit = lamp::lit(&radiance, [0.1; 3], &light).pixel(2, 2);
    let by_hand = 0.5 * (0.1 + expected[0] / std::f64::consts::PI);
    assert!((f64::from(lit[0]) - by_hand).abs() < 1e-5);
}

#[test]
fn a_lamp_in_the_camera_or_behind_a_wall_gives_finite_light() {
    for (name, lamp) in lamps() {
        for meters in [0.001, 0.02, 1.0, 1e4, 1e30] {
            let size = (9, 7);
            let lighting = lighting(vec![lamp], size, FORWARD);
            let range = Plane::filled(9, 7, meters);
            let glow = lamp::airlight(&range, &lighting, 3e-4).light;
            let normals = lamp::normals_of(&range, &lighting.camera);
            let light = lamp::irradiance(&range, &normals, &lighting).light;
            for plane in glow.planes().iter().chain(light.planes()) {
                assert!(
                    plane.data().iter().all(|v| v.is_finite() && *v >= 0.0),
                    "{name} at {meters} m"
                );
            }
        }
    }
}

#[test]
fn a_spot_that_is_aimed_away_gives_no_light_in_view() {
    let away = Lamp::spot([0.0, 0.0, -0.5], [1.0; 3], [0.0, 0.0, -1.0], 40.0).unwrap();
    let lighting = lighting(vec![away], (16, 9), FORWARD);
    let range = range(16, 9);
    let normals = lamp::normals_of(&range, &lighting.camera);
    let light = [
        lamp::airlight(&range, &lighting, 1e-6).light,
        lamp::irradiance(&range, &normals, &lighting).light,
    ];
    let samples = light
        .iter()
        .flat_map(|light| light.planes().iter().flat_map(|p| p.data()));
    assert!(samples.copied().all(|v| v == 0.0));
}

#[test]
fn more_range_shows_more_glow_and_more_attenuation_less() {
    let size = (33, 21);
    let near = lighting(
        vec![Lamp::point([0.4, 0.1, 0.0], [1.0; 3]).unwrap()],
        size,
        FORWARD,
    );
    let murky = Lighting {
        attenuation: near.attenuation.map(|c| 2.0 * c),
        ..near.clone()
    };
    let sum = |range: f32, lighting: &Lighting| {
        let glow = lamp::airlight(&Plane::filled(33, 21, range), lighting, 1e-6).light;
        glow.planes()[1].data().iter().sum::<f32>()
    };
    assert!(sum(1.0, &near) < sum(2.0, &near) && sum(2.0, &near) < sum(f32::INFINITY, &near));
    assert!(sum(2.0, &murky) < sum(2.0, &near));
}

/// With the most nodes only the rounding of f32 remains, in view and next to the camera.
#[test]
fn more_nodes_come_nearer_to_the_reference() {
    let size = (33, 21);
    let range = range(size.0, size.1);
    for (name, lamp) in lamps() {
        let lighting = lighting(vec![lamp], size, FORWARD);
        let exact = lamp::airlight_reference(&range.map(|&z| f64::from(z)), &lighting, REFERENCE_NODES);
        let error = |nodes| worst(&lamp::airlight_with_nodes(&range, &lighting, nodes), &exact);
        let (few, most) = (error(4), error(MOST_NODES));
        assert!(most <= ROUNDING * peak(&exact), "{name}: {most:e}");
        assert!(most <= few, "{name}: {most:e} after {few:e}");
    }
}
