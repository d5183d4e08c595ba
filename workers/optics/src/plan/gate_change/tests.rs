use imaging::random::Stream;
use spec::{Optics, ScatterModel};

use super::*;
use crate::medium::{Kernels, Medium};

const WIDTH: usize = 384;
const HEIGHT: usize = 246;
/// About two of 255 codes of a picture of medium brightness.
const LEAST: f64 = 4e-3;
/// Largest difference of the estimated and the actual share, as a part of the actual one. The largest of these scenes is 0.22.
const TOLERANCE: f64 = 0.25;

fn water(preset: &str) -> Water {
    let optics = Optics {
        preset: Some(preset.to_owned()),
        forward_scatter: Some(ScatterModel::Jaffe.into()),
        ..Optics::default()
    };
    let medium = Medium {
        kernels: Kernels::Two,
        layers: Some(3),
        ..optics.into()
    };
    Water::resolve(&medium, 300.0).unwrap()
}

/// A pile, a plate and a ladder before a wall, the first at `near_m`, with reflectances that differ by `contrast`.
fn inspection(near_m: f32, wall_m: f32, contrast: f32) -> (Rgb<f32>, Plane<f32>) {
    let stream = Stream::stage(3, "gate change");
    let surface = |x: usize, y: usize| match (x, y) {
        (60..95, _) => (near_m, 0.4 - 0.3 * contrast),
        (260..266 | 300..306, _) => (1.4 * near_m, 0.4 - 0.2 * contrast),
        (150..210, 150..200) => (1.2 * near_m, 0.4 + 0.5 * contrast),
        _ => (wall_m * (1.0 + 0.2 * x as f32 / WIDTH as f32), 0.4),
    };
    let range = Plane::from_fn(WIDTH, HEIGHT, |x, y| surface(x, y).0);
    let radiance = Rgb::from_fn(WIDTH, HEIGHT, |x, y| {
        let light = surface(x, y).1 * (0.8 + 0.4 * stream.unit(x as u64 / 3, y as u64 / 3) as f32);
        [light, 0.9 * light, 0.8 * light]
    });
    (radiance, range)
}

fn actual_change(radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water) -> f64 {
    let images = [narrowed(water, 1, Some(3)), narrowed(water, 1, None)].map(|water| {
        let bounds = SceneBounds::measure(radiance, range, &water);
        let plan = Plan::for_water(&bounds, &water, Fidelity::Tolerance(3e-4));
        let layers = chain::water(radiance, range, &water, &plan, &mut KernelCache::new());
        layers.unwrap().scattered
    });
    changed_share(&images[0], &images[1], LEAST)
}

#[test]
fn the_estimate_is_near_the_actual_share_of_changed_pixels() {
    let mut shares = Vec::new();
    for preset in ["jerlov-1C", "jerlov-5C"] {
        let water = water(preset);
        for (near_m, wall_m) in [(1.5, 5.0), (1.0, 2.0), (3.0, 4.5)] {
            for contrast in [0.2, 1.0] {
                let (radiance, range) = inspection(near_m, wall_m, contrast);
                let scene = GateScene {
                    radiance: &radiance,
                    gains: None,
                    range: &range,
                    water: &water,
                };
                let estimate = estimate_gate_change(&scene, LEAST);
                let actual = actual_change(&radiance, &range, &water);
                let tolerance = TOLERANCE * actual;
                shares.push((estimate, actual, tolerance));
            }
        }
    }
    let is_near = |&(estimate, actual, tolerance): &(f64, f64, f64)| (estimate - actual).abs() <= tolerance;
    assert!(shares.iter().all(is_near), "{shares:?}");
    assert!(shares.iter().any(|share| share.1 > 0.05), "{shares:?}");
}

#[test]
fn a_scene_without_an_edge_is_not_changed() {
    let (radiance, _) = inspection(1.0, 5.0, 1.0);
    let range = Plane::from_fn(WIDTH, HEIGHT, |x, _| 2.0 + 0.001 * x as f32);
    let scene = GateScene {
        radiance: &radiance,
        gains: None,
        range: &range,
        water: &water("jerlov-1C"),
    };
    assert_eq!(estimate_gate_change(&scene, 0.0), 0.0);
}
