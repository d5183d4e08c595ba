//! Lamps in patchy water: the fast form against the reference, and both against the field integrated along both legs.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use optics::lamp::{
    self, GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, gauss_legendre, henyey_greenstein,
};
use optics::snow::World;
use optics::turbidity::Field;
use spec::Turbidity;

use crate::errors::{peak, worst};

/// f32 arithmetic in angles, paths and the cosines of the field, as a share of the frame's peak.
const ROUNDING: f64 = 2e-5;
const ATTENUATION: [f64; 3] = [0.778, 0.546, 0.594];
const SCATTERING: [f64; 3] = [0.412, 0.447, 0.435];
const ASYMMETRY: f64 = 0.919;

fn corners(place: impl Fn(f64, f64) -> [f64; 3]) -> Vec<[f64; 3]> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    corners.map(|[x, y]| place(x, y)).to_vec()
}

fn points(places: &[[f64; 3]]) -> Vec<Lamp> {
    places
        .iter()
        .map(|&p| Lamp::point(p, [1.0; 3]).unwrap())
        .collect()
}

/// Four lamps next to the camera as points and as spots, and four in view.
fn cases() -> [(&'static str, Vec<Lamp>); 3] {
    let beside = corners(|x, y| [0.4 * x, 0.25 * y, 0.0]);
    let spot = |p: &[f64; 3]| Lamp::spot(*p, [1.0; 3], [-0.25 * p[0], 0.0, 1.0], 35.0).unwrap();
    [
        ("points", points(&beside)),
        ("spots", beside.iter().map(spot).collect()),
        ("in view", points(&corners(|x, y| [0.5 * x, 0.3 * y, 1.5]))),
    ]
}

fn lighting(lamps: Vec<Lamp>, (width, height): (usize, usize), patches: Option<Field>) -> Lighting {
    Lighting {
        lamps,
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(0.6 * width as f64, width, height),
        attenuation: ATTENUATION,
        scattering: SCATTERING,
        absorption: None,
        phase: GlowPhase::henyey_greenstein(ASYMMETRY),
        patches,
    }
}

fn field(contrast: f64, scale_m: f64, index: u64) -> Field {
    Field::new(&Turbidity { contrast, scale_m }, World { seed: 5, index })
}

/// From 1 to 6 m, with a hole.
fn range(width: usize, height: usize) -> Plane<f64> {
    Plane::from_fn(width, height, |x, y| match (x, y) {
        (2, 1) => f64::NAN,
        _ => 1.0 + 5.0 * y as f64 / height as f64 + 0.01 * x as f64,
    })
}

#[test]
fn the_fast_form_stays_within_its_tolerance_of_the_reference() {
    for size in [(1, 1), (3, 2), (17, 13), (64, 5), (131, 37)] {
        let exact_range = range(size.0, size.1);
        let range = exact_range.map(|&z| z as f32);
        for (name, lamps) in cases() {
            for (contrast, scale_m) in [(0.3, 0.1), (0.95, 0.7), (0.9, 20.0)] {
                let lighting = lighting(lamps.clone(), size, Some(field(contrast, scale_m, 1)));
                let exact = lamp::airlight_reference(&exact_range, &lighting, REFERENCE_NODES);
                for tolerance in [3e-4, 1e-5] {
                    let fast = lamp::airlight(&range, &lighting, tolerance);
                    let error = worst(&fast.light, &exact);
                    let allowed = tolerance + fast.rounding.min(ROUNDING * peak(&exact));
                    assert!(
                        error <= allowed,
                        "{name}, {contrast}, {scale_m} m, {size:?}: {error:e}"
                    );
                }
                let normals = lamp::normals_of(&range, &lighting.camera);
                let exact = lamp::irradiance_reference(&exact_range, &normals, &lighting);
                let fast = lamp::irradiance(&range, &normals, &lighting);
                let error = worst(&fast.light, &exact);
                assert!(
                    error <= fast.rounding.min(ROUNDING * peak(&exact)),
                    "{name}, {contrast}, {scale_m} m, {size:?}: {error:e}"
                );
            }
        }
    }
}

/// Spots next to the camera, whose spread light is interpolated between rays and degrees of turbidity.
#[test]
fn light_scattered_more_than_once_stays_within_its_tolerance() {
    let size = (67, 29);
    let exact_range = range(size.0, size.1);
    let range = exact_range.map(|&z| z as f32);
    for (contrast, scale_m) in [(0.3, 0.1), (0.95, 0.7), (0.9, 20.0)] {
        let spots = cases()[1].1[..2].to_vec();
        let lighting = Lighting {
            absorption: Some([0.366, 0.099, 0.159]),
            ..lighting(spots, size, Some(field(contrast, scale_m, 1)))
        };
        let exact = lamp::airlight_reference(&exact_range, &lighting, REFERENCE_NODES);
        for tolerance in [3e-4, 1e-5] {
            let fast = lamp::airlight(&range, &lighting, tolerance);
            let error = worst(&fast.light, &exact);
            // For the smaller one the halvings may leave a larger error, which the report includes.
            assert!(
                fast.left <= tolerance.max(2e-5),
                "{contrast}, {scale_m} m: {:e}",
                fast.left
            );
            assert!(
                error <= fast.left + fast.rounding.min(ROUNDING * peak(&exact)),
                "{contrast}, {scale_m} m: {error:e}"
            );
        }
    }
}

#[test]
fn patches_without_contrast_change_no_bit() {
    let size = (131, 37);
    let range = range(size.0, size.1).map(|&z| z as f32);
    for (name, lamps) in cases() {
        let [even, flat] =
            [None, Some(field(0.0, 1.0, 3))].map(|patches| lighting(lamps.clone(), size, patches));
        let normals = lamp::normals_of(&range, &even.camera);
        let both = |lighting: &Lighting| {
            let glow = lamp::airlight(&range, lighting, 3e-4).light;
            (glow, lamp::irradiance(&range, &normals, lighting).light)
        };
        assert_eq!(both(&even), both(&flat), "{name}");
    }
}

/// Mean of the field between two points.
fn between(field: &Field, from: [f64; 3], to: [f64; 3], rule: &[(f64, f64)]) -> f64 {
    let at = |x: f64| field.factor_at([0, 1, 2].map(|i| from[i] + 0.5 * (x + 1.0) * (to[i] - from[i])));
    rule.iter().map(|(x, weight)| 0.5 * weight * at(*x)).sum()
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Green airlight and light on surfaces with the field at every node and along both legs, of one pixel and one lamp that lights all
/// of it.
fn marched(
    field: &Field,
    ray: [f64; 3],
    z: f64,
    place: [f64; 3],
    shines: &dyn Fn([f64; 3]) -> f64,
) -> [f64; 2] {
    let (nodes, leg) = (gauss_legendre(64), gauss_legendre(12));
    let (c, b) = (ATTENUATION[1], SCATTERING[1]);
    let nearest: f64 = (0..3).map(|i| ray[i] * place[i]).sum();
    let across = length([0, 1, 2].map(|i| nearest * ray[i] - place[i])).max(LAMP_RADIUS_M);
    let (from, to) = ((-nearest / across).atan(), ((z - nearest) / across).atan());
    let mut glow = 0.0;
    for (node, weight) in &nodes {
        let angle = 0.5 * (from + to) + 0.5 * (to - from) * node;
        let t = nearest + across * angle.tan();
        let point = ray.map(|v| t * v);
        let path = t * between(field, [0.0; 3], point, &leg)
            + across / angle.cos() * between(field, place, point, &leg);
        let scattered = b * field.factor_at(point) * henyey_greenstein(ASYMMETRY, -angle.sin());
        glow += 0.5 * (to - from) / across * weight * shines(point) * scattered * (-c * path).exp();
    }
    let point = ray.map(|v| z * v);
    let meters = length([0, 1, 2].map(|i| point[i] - place[i]));
    let arrives = (-c * meters * between(field, place, point, &leg)).exp() / (meters * meters);
    [glow, shines(point) * arrives]
}

/// Mean error of the model as a share of the mean light, over six worlds: of the airlight and of the light on surfaces, each with
/// one factor for a ray and with the mean water.
fn model_error(lamps: &[Lamp], spot: bool, contrast: f64, scale_m: f64) -> [[f64; 2]; 2] {
    let size = (12, 8);
    let range = Plane::from_fn(size.0, size.1, |_, y| 1.0 + 5.0 * y as f64 / size.1 as f64);
    let (mut errors, mut light) = ([[0.0; 2]; 2], [0.0; 2]);
    for index in 0..6 {
        let field = field(contrast, scale_m, index);
        let models = [Some(field), None].map(|patches| lighting(lamps.to_vec(), size, patches));
        let glows = models
            .each_ref()
            .map(|model| lamp::airlight_reference(&range, model, REFERENCE_NODES));
        for (y, x) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (y, x))) {
            let camera = &models[0].camera;
            let v = [
                (x as f64 - camera.cx) / camera.focal_px,
                (y as f64 - camera.cy) / camera.focal_px,
                1.0,
            ];
            let (ray, z) = (v.map(|c| c / length(v)), range.pixel(x, y));
            let mut exact = [0.0; 2];
            for lamp in lamps {
                let place = lamp.position_m();
                let aim = [-0.25 * place[0], 0.0, 1.0];
                let shines = |point: [f64; 3]| {
                    if !spot {
                        return 1.0;
                    }
                    let way = [0, 1, 2].map(|i| point[i] - place[i]);
                    let along: f64 = (0..3).map(|i| way[i] * aim[i]).sum();
                    let cos = along / (length(way) * length(aim));
                    let edge = 35f64.to_radians().cos();
                    ((cos - edge) / (1.0 - edge)).clamp(0.0, 1.0)
                };
                let both = marched(&field, ray, z, place, &shines);
                exact = [exact[0] + both[0], exact[1] + both[1]];
            }
            // Surfaces that face every lamp: only the path to them is compared.
            let white = models
                .each_ref()
                .map(|model| lamp::white_at(ray.map(|v| z * v), model, None)[1] * std::f64::consts::PI);
            for model in 0..2 {
                errors[0][model] += (glows[model].pixel(x, y)[1] - exact[0]).abs();
                errors[1][model] += (white[model] - exact[1]).abs();
            }
            light = [light[0] + exact[0], light[1] + exact[1]];
        }
    }
    [0, 1].map(|kind| errors[kind].map(|error| error / light[kind]))
}

/// The figures of docs/science/suspended-matter.md: one factor for each ray instead of the field along both legs.
#[test]
fn one_factor_for_a_ray_comes_much_nearer_than_the_mean_water() {
    // Mean error of the airlight and of the light on surfaces: patches of 1.2 and of 4 m.
    let most = [
        ("points", [[0.03, 0.05], [0.01, 0.02]]),
        ("spots", [[0.15, 0.06], [0.07, 0.03]]),
        ("in view", [[0.08, 0.13], [0.03, 0.04]]),
    ];
    for ((name, lamps), (of, most)) in cases().into_iter().zip(most) {
        assert_eq!(name, of);
        for (scale_m, most) in [1.2, 4.0].into_iter().zip(most) {
            let errors = model_error(&lamps, name == "spots", 0.9, scale_m);
            for (kind, ([factor, mean], most)) in
                ["glow", "surfaces"].into_iter().zip(errors.into_iter().zip(most))
            {
                println!("{name}, {scale_m} m, {kind}: {factor:.3}, mean water {mean:.3}");
                assert!(
                    factor <= most && factor < 0.8 * mean,
                    "{name}, {scale_m} m, {kind}: {factor} and {mean}"
                );
            }
        }
    }
}
