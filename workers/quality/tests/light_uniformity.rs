//! Light uniformity on sequences with known light.

#![allow(clippy::unwrap_used)]

use imaging::{Rgb8, transfer};
use quality::{MetricId, measure};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;

fn uniformity(picture: &Rgb8) -> f64 {
    measure(picture, None, &[MetricId::parse("light_uniformity").unwrap()]).unwrap()[0].1
}

fn grain(x: usize, y: usize) -> f64 {
    let mut hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    f64::from(hash >> 24) / 255.0
}

/// A stony floor under even light and a lamp: its center relative to the width, and its strength relative to the even
/// light.
fn floor(lamp: (f64, f64), strength: f64, exposure: f64) -> Rgb8 {
    Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
        let (u, v) = (x as f64 / WIDTH as f64 - lamp.0, y as f64 / WIDTH as f64 - lamp.1);
        // An isotropic lamp a fifth of the width above the floor.
        let lit = 0.1 + strength / (1.0 + (u * u + v * v) / 0.04).powf(1.5);
        let stone = 0.25 + 0.35 * grain(x / 6, y / 6);
        [0.8, 1.0, 0.9]
            .map(|tint| (255.0 * transfer::encode((exposure * lit * stone * tint).min(1.0)) + 0.5) as u8)
    })
}

/// The lamp's position along the width and the measured value, from far left of the view (0..1) to far right.
fn passing_lamp() -> Vec<(f64, f64)> {
    let places = (0..=24).map(|step| -1.5 + 4.0 * f64::from(step) / 24.0);
    places
        .map(|u| (u, uniformity(&floor((u, 0.375), 1.0, 1.0))))
        .collect()
}

#[test]
fn even_light_on_a_textured_floor_is_near_one() {
    let even = uniformity(&floor((0.5, 0.375), 0.0, 1.0));
    assert!(even > 0.95, "{even}");
}

#[test]
fn a_lamp_that_passes_by_lowers_it_while_it_is_in_view_and_gives_it_back() {
    let seen = passing_lamp();
    for &(u, value) in &seen {
        match u {
            _ if (0.0..=1.0).contains(&u) => assert!(value < 0.65, "{seen:?}"),
            _ if !(-1.0..=2.0).contains(&u) => assert!(value > 0.9, "{seen:?}"),
            _ => {}
        }
    }
    // It falls as the lamp approaches, and the way out mirrors the way in.
    let entering: Vec<f64> = seen
        .iter()
        .filter(|(u, _)| *u < 0.0)
        .map(|(_, value)| *value)
        .collect();
    assert!(entering.windows(2).all(|pair| pair[1] < pair[0]), "{seen:?}");
    for ((_, one), (_, other)) in seen.iter().zip(seen.iter().rev()) {
        assert!((one - other).abs() < 0.02, "{seen:?}");
    }
}

#[test]
fn a_stronger_lamp_is_less_even() {
    let strengths = [0.0, 0.05, 0.1, 0.3, 1.0, 3.0];
    let seen = strengths.map(|strength| uniformity(&floor((0.2, 0.2), strength, 0.3)));
    assert!(seen.windows(2).all(|pair| pair[1] < pair[0]), "{seen:?}");
}

#[test]
fn exposure_does_not_matter() {
    let [dark, bright] = [0.25, 1.0].map(|exposure| uniformity(&floor((0.3, 0.3), 0.6, exposure)));
    assert!((dark - bright).abs() < 0.01, "{dark} {bright}");
}

#[test]
fn a_lamp_moved_within_the_view_changes_it_little_beside_taking_it_away() {
    let measure_lamp = |u: f64, v: f64| uniformity(&floor((u, v), 1.0, 1.0));
    let (center, beside) = (measure_lamp(0.5, 0.375), measure_lamp(0.6, 0.3));
    let without = uniformity(&floor((0.5, 0.375), 0.0, 1.0));
    assert!(
        (center - beside).abs() < 0.2 * (without - center),
        "{center} {beside} {without}"
    );
}

#[test]
fn texture_smaller_than_a_cell_does_not_matter() {
    let checker = |contrast: f64| {
        Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
            let light = 0.3
                + if (x / 4 + y / 4) % 2 == 0 {
                    contrast
                } else {
                    -contrast
                };
            [(255.0 * transfer::encode(light) + 0.5) as u8; 3]
        })
    };
    let [plain, strong] = [0.0, 0.29].map(|contrast| uniformity(&checker(contrast)));
    assert!(plain == 1.0 && strong > 0.97, "{plain} {strong}");
}

#[test]
fn one_color_black_and_one_pixel_are_even() {
    for (width, height) in [(1, 1), (3, 2), (50, 40)] {
        for pixel in [[0; 3], [255; 3], [60, 120, 140]] {
            assert_eq!(uniformity(&Rgb8::from_fn(width, height, |_, _| pixel)), 1.0);
        }
    }
}
