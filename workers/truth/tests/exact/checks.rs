//! Exact results of radiative transfer, and invariants of every scene.

use std::f64::consts::PI;

use crate::support::{Mean, Solids, TestSolid, along, lamp, radiance, scene, water};
use imaging::vector::{DVec3, vec3};
use optics::lamp::FournierForand;
use truth::{Address, Along, Lambertian, Phase, Sea, SeaSun, SphereLamp, TurbidityField, WaterLayers};

const UP: DVec3 = vec3(0.0, -1.0, 0.0);

fn average() -> Phase {
    Phase::fournier_forand(FournierForand::of_backscatter(0.0183))
}

#[test]
fn a_bright_wall_in_water_that_only_absorbs_fades_exactly() {
    let solids = Solids(vec![TestSolid::Wall(3.0)]);
    let scene = scene(
        &solids,
        vec![Lambertian::glowing(1.0)],
        water(0.4, 0.0),
        average(),
    );
    for direction in [[0.0, 0.0, 1.0], [0.3, -0.2, 1.0], [-1.0, 0.5, 1.0]] {
        let along = along(direction);
        let range = 3.0 / along.direction.z;
        let [never, _, _, all] = radiance(&scene, along, 0, 32);
        assert!((never.mean - (-0.4 * range).exp()).abs() < 1e-12);
        assert_eq!(all.mean, never.mean);
    }
}

/// Single-scattered light of a lamp, by the midpoint rule in the angle at the lamp.
fn single(phase: &Phase, lamp: &SphereLamp, along: Along, end: f64, b: f64, c: f64) -> f64 {
    let nearest = along.direction.dot(lamp.place);
    let offset = (lamp.place.dot(lamp.place) - nearest * nearest).sqrt();
    let (from, to) = ((-nearest / offset).atan(), ((end - nearest) / offset).atan());
    let steps = 20_000;
    let step = |i: usize| {
        let angle = from + (to - from) * (i as f64 + 0.5) / steps as f64;
        let reach = offset / angle.cos();
        let scattered = phase.density(1.0 + angle.sin());
        let toward = along.direction * (nearest + offset * angle.tan()) + -lamp.place;
        let profile = lamp.profile(toward.normalized());
        profile * scattered * (-c * (nearest + offset * angle.tan() + reach)).exp()
    };
    b / offset * (0..steps).map(step).sum::<f64>() * (to - from) / steps as f64
}

#[test]
fn light_of_a_lamp_that_is_scattered_once_is_the_quadrature() {
    let solids = Solids(vec![TestSolid::Wall(4.0)]);
    let phase = average();
    for (number, (a, b)) in [(0.114, 0.037), (0.179, 0.219), (0.366, 1.824)]
        .into_iter()
        .enumerate()
    {
        let spot = SphereLamp {
            beam: Some((vec3(0.2f64, 0.0, 1.0).normalized(), 35f64.to_radians().cos())),
            ..lamp([-0.5, 0.1, 0.2], 1.0)
        };
        for (kind, lamp) in [lamp([0.3, -0.2, 0.0], 1.0), spot].into_iter().enumerate() {
            let mut scene = scene(&solids, vec![Lambertian::BLACK], water(a, b), phase.clone());
            scene.lamps = vec![lamp];
            let (mut found, mut error, mut expected) = (0.0, 0.0f64, 0.0);
            for ray in 0..6u64 {
                let along = along([0.1 * ray as f64 - 0.2, 0.03 * ray as f64, 1.0]);
                let once = radiance(&scene, along, ray, 4000)[1];
                let exact = single(&phase, &lamp, along, 4.0 / along.direction.z, b, a + b);
                once.agrees(exact, 0.0, &format!("water {number}, lamp {kind}, ray {ray}"));
                found += once.mean;
                error = error.hypot(once.error);
                expected += exact;
            }
            assert!(error < 0.02 * expected, "{error} of {expected}");
            assert!(
                (found - expected).abs() <= 3.0 * error,
                "{found} and {expected} ± {error}"
            );
        }
    }
}

#[test]
fn unscattered_light_of_a_lamp_with_a_shadow_is_exact() {
    let block = TestSolid::Block {
        low: [-0.1, -0.2, 1.2],
        high: [0.25, 0.25, 1.5],
    };
    let solids = Solids(vec![TestSolid::Wall(3.0), block]);
    let materials = vec![Lambertian::gray(0.5), Lambertian::BLACK];
    let mut scene = scene(&solids, materials, water(0.179, 0.219), average());
    let lamp = lamp([-0.4, -0.3, 0.0], 1.0);
    scene.lamps = vec![lamp];
    let (mut lit, mut dark) = (0, 0);
    for pixel in 0..400 {
        let (x, y) = (
            f64::from(pixel % 20) / 10.0 - 0.95,
            f64::from(pixel / 20) / 14.0 - 0.7,
        );
        let along = along([x, y, 1.0]);
        let found = radiance(&scene, along, 0, 32)[0].mean;
        // The box hides a part of the wall.
        let (near, far) = (
            along.direction * (1.2 / along.direction.z),
            along.direction * (3.0 / along.direction.z),
        );
        let is_inside = |place: DVec3, low: [f64; 3], high: [f64; 3]| {
            place.x > low[0] && place.x < high[0] && place.y > low[1] && place.y < high[1]
        };
        let (low, high) = ([-0.1, -0.2], [0.25, 0.25]);
        let steps = 2000;
        let hides = |from: DVec3, to: DVec3| {
            (1..steps).any(|i| {
                let position = from + (to + -from) * (f64::from(i) / f64::from(steps));
                position.z > 1.2
                    && position.z < 1.5
                    && is_inside(position, [low[0], low[1], 0.0], [high[0], high[1], 0.0])
            })
        };
        if is_inside(near, [-0.13, -0.23, 0.0], [0.28, 0.28, 0.0]) || hides(vec3(0.0, 0.0, 0.0), far) {
            continue;
        }
        let away = lamp.place + -far;
        let reach = away.length();
        let c = 0.398;
        let expected = if hides(far, lamp.place) {
            dark += 1;
            0.0
        } else {
            lit += 1;
            let facing = 3.0 / reach;
            0.5 / PI * facing / (reach * reach) * (-c * (reach + far.length())).exp()
        };
        let peak = 0.5 / PI / 9.0 * (-c * 6.0f64).exp();
        // The steps above do not resolve rays that graze the box.
        if (found - expected).abs() > 1e-4 * peak {
            let grazes = found == 0.0 || expected == 0.0;
            assert!(grazes, "{along:?}: {found}, expected {expected}");
            dark -= 1;
        }
    }
    assert!(lit > 200 && dark > 10, "{lit} lit, {dark} dark");
}

/// Reflected and transmitted light of a slab between z = 0 and a depth at normal incidence; without noise for
/// unscattered light.
fn slab(phase: Phase, albedo: f64, depth: f64, paths: u64) -> [Mean; 2] {
    let solids = Solids(vec![TestSolid::Wall(-1e-9), TestSolid::Wall(depth)]);
    [0, 1].map(|side| {
        let mut materials = vec![Lambertian::BLACK; 2];
        materials[side] = Lambertian::glowing(1.0);
        let scene = scene(&solids, materials, water(1.0 - albedo, albedo), phase.clone());
        radiance(&scene, along([0.0, 0.0, 1.0]), side as u64, paths)[3]
    })
}

#[test]
fn a_slab_reflects_and_transmits_as_published() {
    // Van de Hulst 1980, table 35.
    let [reflected, transmitted] = slab(Phase::henyey_greenstein(0.75), 0.9, 2.0, 200_000);
    reflected.agrees(0.09739, 1e-5, "reflected");
    transmitted.agrees(0.66096, 1e-5, "transmitted");
    assert!(reflected.error < 0.001 && transmitted.error < 0.001);
}

#[test]
fn a_half_space_of_isotropic_water_reflects_as_chandrasekhar_says() {
    let albedo = 0.9;
    // 1/H(μ) = √(1 − ω) + ω/2 ∫ x H(x)/(μ + x) dx, by iteration on the midpoint rule.
    let n = 400;
    let mu = |i: usize| (i as f64 + 0.5) / n as f64;
    let mut h = vec![1.0; n];
    let root = f64::sqrt(1.0 - albedo);
    let next = |h: &[f64], at: f64| {
        let sum: f64 = (0..n).map(|i| mu(i) * h[i] / (at + mu(i))).sum::<f64>() / n as f64;
        1.0 / (root + 0.5 * albedo * sum)
    };
    for _ in 0..200 {
        h = (0..n).map(|i| next(&h, mu(i))).collect();
    }
    let exact = 1.0 - root * next(&h, 1.0);
    assert!((exact - 0.41495).abs() < 1e-4, "{exact}");
    let [reflected, _] = slab(Phase::henyey_greenstein(0.0), albedo, 1e9, 60_000);
    reflected.agrees(exact, 0.0, "half space");
}

#[test]
fn a_slab_that_absorbs_nothing_loses_nothing() {
    let solids = Solids(vec![TestSolid::Wall(-1e-9), TestSolid::Wall(2.0)]);
    let phase = Phase::henyey_greenstein(0.5);
    let scene = scene(&solids, vec![Lambertian::glowing(1.0); 2], water(0.0, 1.0), phase);
    let all = radiance(&scene, along([0.0, 0.0, 1.0]), 0, 20_000)[3];
    assert!((all.mean - 1.0).abs() < 1e-12 && all.error < 1e-12, "{all:?}");
}

#[test]
fn layers_of_the_same_optical_depth_are_the_same_slab() {
    let solids = Solids(vec![TestSolid::Wall(-1e-9), TestSolid::Wall(2.0)]);
    let phase = Phase::henyey_greenstein(0.75);
    let mut scene = scene(
        &solids,
        vec![Lambertian::BLACK, Lambertian::glowing(1.0)],
        water(0.1, 0.9),
        phase,
    );
    // One meter of half and one of half as much again: two in all.
    scene.turbidity = TurbidityField::Layers(WaterLayers {
        up: vec3(0.0, 0.0, -1.0),
        depth_m: 0.0,
        edges_m: vec![1.0],
        factors: vec![0.5, 1.5],
    });
    let all = radiance(&scene, along([0.0, 0.0, 1.0]), 0, 100_000)[3];
    all.agrees(0.66096, 1e-5, "transmitted");
}

#[test]
fn flux_deep_in_isotropic_water_falls_by_the_diffusion_exponent() {
    let deep = |depth| slab(Phase::henyey_greenstein(0.0), 0.9, depth, 80_000)[1];
    let (near, far) = (deep(5.0), deep(8.0));
    let k = (near.mean / far.mean).ln() / 3.0;
    let error = (near.error / near.mean).hypot(far.error / far.mean) / 3.0;
    // (ω/2k) ln((1 + k)/(1 − k)) = 1; the exponent is reached to 1 % at these depths.
    assert!((k - 0.52543).abs() < 4.0 * error + 0.006, "{k} ± {error}");
    assert!(error < 0.015);
}

fn room() -> Solids {
    let block = TestSolid::Block {
        low: [-1.0, -1.5, -0.5],
        high: [1.2, 1.0, 2.0],
    };
    Solids(vec![block])
}

#[test]
fn a_closed_room_that_sends_out_what_it_takes_is_even() {
    let rooms = room();
    let half = Lambertian {
        reflectance: [0.5; 3],
        emitted: [0.5; 3],
    };
    let even = scene(&rooms, vec![half], water(0.0, 0.6), average());
    let turbidity = TurbidityField::Layers(WaterLayers {
        up: UP,
        depth_m: 3.0,
        edges_m: vec![2.5, 3.2],
        factors: vec![0.2, 3.0, 1.0],
    });
    let turbid = truth::TracedScene {
        turbidity,
        ..scene(&rooms, vec![half], water(0.0, 0.6), average())
    };
    for scene in [even, turbid] {
        for direction in [[0.0, 0.0, 1.0], [1.0, 0.2, 0.1], [-0.4, 0.6, -1.0]] {
            radiance(&scene, along(direction), 0, 20_000)[3].agrees(1.0, 0.0, "furnace");
        }
    }
}

#[test]
fn a_lamp_and_the_place_it_is_seen_from_can_change_places() {
    // Light at a point from a lamp at another, over all directions; a bright block next to one of them.
    let block = TestSolid::Block {
        low: [0.3, -0.6, 0.4],
        high: [0.9, 0.6, 1.4],
    };
    let solids = Solids(vec![block]);
    let places = [[0.0, 0.0, 0.0], [0.1, 0.2, 1.5]];
    let fluence = |from: [f64; 3], to: [f64; 3]| {
        let mut scene = scene(
            &solids,
            vec![Lambertian::gray(0.8)],
            water(0.2, 0.5),
            Phase::henyey_greenstein(0.6),
        );
        scene.lamps = vec![lamp(from, 1.0)];
        let directions = 4096;
        let values: Vec<f64> = (0..32)
            .map(|batch| {
                let light = (batch..directions).step_by(32).map(|k| {
                    // Fibonacci's sphere.
                    let height = 1.0 - (2.0 * k as f64 + 1.0) / directions as f64;
                    let (sin, cos) = (2.399_963_229_728_653 * k as f64).sin_cos();
                    let ring = (1.0 - height * height).sqrt();
                    let along = Along {
                        origin: to.into(),
                        direction: vec3(ring * cos, ring * sin, height).normalized(),
                    };
                    (0..24)
                        .map(|sample| {
                            let address = Address {
                                frame: 0,
                                pixel: k as u64,
                                sample,
                                channel: 0,
                            };
                            let tally = scene.trace(along, truth::stream(3), address);
                            tally.orders.iter().flatten().sum::<f64>() / 24.0
                        })
                        .sum::<f64>()
                });
                light.sum::<f64>() * 4.0 * PI * 32.0 / directions as f64
            })
            .collect();
        Mean::from_batches(&values)
    };
    let [there, back] = [fluence(places[0], places[1]), fluence(places[1], places[0])];
    there.agrees(back.mean, back.error, "reciprocity");
    assert!(there.error < 0.05 * there.mean, "{there:?}");
}

#[test]
fn the_sun_lights_a_floor_and_the_water_above_it() {
    // A level floor 2 m below the camera, the sun at the zenith, purely absorbing water: E ρ/π e^{−a (z + Z)}.
    let below = TestSolid::Block {
        low: [-100.0, 2.0, -100.0],
        high: [100.0, 3.0, 100.0],
    };
    let solids = Solids(vec![below]);
    let sea = Sea {
        up: UP,
        depth_m: 5.0,
        sky: [0.0; 3],
        sun: Some(SeaSun {
            direction: UP,
            irradiance: [1.0; 3],
        }),
    };
    let mut clear = scene(&solids, vec![Lambertian::gray(1e-5)], water(0.1, 0.0), average());
    clear.sea = Some(sea);
    let along = along([0.0, 1.0, 1.0]);
    let found = radiance(&clear, along, 0, 32)[3].mean;
    // The sea surface reflects almost no light of a floor this dark back to it.
    let expected = 1e-5 / PI * (-0.1 * (7.0 + 2.0 * 2f64.sqrt())).exp();
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} and {expected}");
    // Single scattering toward a level look in open water: b p(90°) E e^{−c h} ∫ e^{−c t} dt.
    let empty = Solids(Vec::new());
    let mut open = scene(&empty, Vec::new(), water(0.2, 0.3), Phase::henyey_greenstein(0.5));
    open.sea = Some(sea);
    let found = radiance(&open, crate::support::along([0.0, 0.0, 1.0]), 0, 40_000)[1];
    let expected = 0.3 * optics::lamp::henyey_greenstein(0.5, 0.0) * (-0.5f64 * 5.0).exp() / 0.5;
    found.agrees(expected, 0.005 * expected, "sun in water");
}
