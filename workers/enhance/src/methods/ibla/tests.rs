use imaging::codec::decode_picture;

use super::super::vectors::{VARIANTS, assert_picture, assert_plane, cases, expected, file, numbers};
use super::*;
use crate::blocks::{calmest, lowest};

/// Near ties flip single pixels of a candidate.
const LIGHT_TOLERANCE: f64 = 0.01;
/// Tolerance of refined planes relative to their range.
const PLANE_TOLERANCE: f64 = 1e-3;

/// A variant: its name, its refinement of a plane, and the complete method.
type Refined<'a> = (
    &'static str,
    &'a dyn Fn(&Plane<f64>) -> Plane<f64>,
    fn(&Raster, Variant) -> Enhanced,
);

#[test]
fn golden_stages_and_pictures() {
    let expected = expected();
    for name in cases() {
        let picture = decode_picture(file(name, "input.png")).unwrap();
        let colors = picture.to_rgb8();
        let guide = Guide::new(&colors);
        for variant in VARIANTS {
            let matting = Matting::new(&guide, variant);
            let by_guide = |plane: &Plane<f64>| guided(&guide, plane, variant);
            let by_matting = |plane: &Plane<f64>| matting.refined(plane);
            let forms: [Refined; 2] = [
                ("ibla", &by_matting, enhance),
                ("ibla_guided", &by_guide, enhance_guided),
            ];
            for (form, refine, method) in forms {
                let expected = &expected[name][form];
                let raw = blurriness(&colors, variant);
                let refined = refine(&raw);
                let light = BackgroundLight::new(&colors, &refined, variant);
                let boxes = [calmest(&colors), lowest(&refined)].map(|region| {
                    let (x, y) = (&region.columns, &region.rows);
                    [x.start, y.start, x.len(), y.len()].map(|number| number as f64)
                });
                for (region, expected) in boxes.iter().zip(expected["boxes"].as_array().unwrap()) {
                    assert_eq!(*region, numbers(expected), "{name} {form} {variant:?}");
                }
                for (got, expected) in light.color.iter().zip(numbers::<3>(&expected["light"])) {
                    assert!(
                        (got - expected).abs() < LIGHT_TOLERANCE,
                        "{name} {form} {variant:?}"
                    );
                }
                let mix = Mix::new(&guide, light.color);
                if form == "ibla" {
                    assert_plane(name, "ibla_blur.npy", &refined, PLANE_TOLERANCE);
                    let closeness = refine(&mix.closeness(&Measures::new(&guide, raw.clone(), variant)));
                    assert_plane(name, "ibla_closeness.npy", &closeness, PLANE_TOLERANCE);
                }
                let got = [mix.by_loss, mix.by_color, nearest(&colors, light.color)];
                for (got, key) in got.into_iter().zip(["ta", "tb", "near"]) {
                    let expected = expected[key].as_f64().unwrap();
                    assert!(
                        (got - expected).abs() < 0.05,
                        "{name} {form} {key}: {got} for {expected}"
                    );
                }
                assert_picture(name, form, &method(&picture, variant).picture.to_rgb8());
            }
        }
    }
}

fn ibla(colors: &Rgb8, variant: Variant) -> Rgb8 {
    enhance(&Raster::from(colors.clone()), variant).picture.to_rgb8()
}

#[test]
fn one_color_and_black_come_back() {
    for pixel in [[0; 3], [60, 120, 140], [255; 3]] {
        let picture = Rgb8::from_fn(40, 30, |_, _| pixel);
        for variant in VARIANTS {
            assert_eq!(ibla(&picture, variant), picture, "{pixel:?}");
        }
    }
}

#[test]
fn shorter_waves_fade_less_under_white_light() {
    let [red, green, blue] = attenuation([0.5; 3]);
    assert_eq!(red, 1.0 / 7.0);
    // m = 0.92457, 1.01497 and 1.11667: under equal light the shorter waves scatter more.
    assert!((green / red - 1.01497 / 0.92457).abs() < 1e-9 && blue > green);
    // Without blue light the division has a floor.
    assert!(attenuation([0.5, 0.5, 0.0])[2].is_finite());
}

#[test]
fn bright_haze_is_not_blackened_and_a_bright_wall_is_named() {
    let haze = decode_picture(file("peers_hazy_160x120", "input.png")).unwrap();
    assert!(
        !enhance(&haze, Variant::Fast)
            .warnings
            .contains(&Warning::Blackened)
    );
    let wall = Rgb8::from_fn(160, 120, |x, y| {
        let texture = ((x / 3 + y / 5) % 4) as u8 * 8;
        if y < 64 {
            [235, 240, 238]
        } else {
            [30 + texture, 70 + texture, 80 + texture]
        }
    });
    let warnings = enhance(&Raster::from(wall), Variant::Fast).warnings;
    assert!(warnings.contains(&Warning::Blackened) && warnings.contains(&Warning::LampAsBackground));
}

/// Tolerance of the hybrid's candidates in pictures where noise decides which pixels are the most blurred. 97 % of
/// rendered frames are within [`LIGHT_TOLERANCE`]: `docs/science/enhancement.md`.
const NOISY_LIGHT_TOLERANCE: f64 = 0.05;

/// Water, darker with depth, and objects that lose contrast with distance, with noise.
fn scene(seed: usize) -> Rgb8 {
    let (width, height) = (547, 353);
    let random = |n: usize| {
        let mixed = ((n + 977 * seed) as u32 ^ 0x5bd1).wrapping_mul(0x9e37_79b1);
        (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d) >> 16
    };
    let part = |n: usize| f64::from(random(n)) / 65_536.0;
    let water = [0.1 + 0.2 * part(1), 0.3 + 0.3 * part(2), 0.3 + 0.4 * part(3)];
    Rgb8::from_fn(width, height, |x, y| {
        let (u, v) = (x as f64 / width as f64, y as f64 / height as f64);
        let mut color = water.map(|light| light * (1.1 - 0.5 * v) * (1.0 - 0.3 * (u - part(4)).abs()));
        for thing in 0..6 {
            let [left, top, wide, high] = [10, 11, 12, 13].map(|n| part(n + 10 * thing));
            if (left..left + 0.1 + 0.3 * wide).contains(&u) && (top..top + 0.1 + 0.3 * high).contains(&v) {
                let texture = 0.2 * f64::from((x / (3 + thing) + y / 5) as u8 % 4);
                let near = 0.1 + 0.8 * part(14 + 10 * thing);
                color = color.map(|light| light + near * (texture + 0.3 * wide - light) * 0.7);
            }
        }
        std::array::from_fn(|c| {
            let noise = part(1000 + 3 * (x + width * y) + c) - 0.5;
            (255.0 * color[c] + 1.5 * noise).clamp(0.0, 255.0) as u8
        })
    })
}

#[test]
fn the_hybrid_stays_near_the_candidates_of_matting() {
    for seed in 0..20 {
        let picture = scene(seed);
        let [got, expected] = [IblaRefinement::Hybrid, IblaRefinement::Matting]
            .map(|form| candidates(&picture, form, Variant::Fast));
        for (got, expected) in got.as_flattened().iter().zip(expected.as_flattened()) {
            assert!(
                (got - expected).abs() < NOISY_LIGHT_TOLERANCE,
                "scene {seed}: {got} for {expected}"
            );
        }
    }
}
