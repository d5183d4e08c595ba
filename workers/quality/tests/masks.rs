//! Metrics of the part of a picture inside a mask.

#![allow(clippy::unwrap_used)]

use imaging::{Plane, Rgb8};
use quality::{MetricId, Needs, QualityError, Subject, measure_subject};

fn noise(x: usize, y: usize, salt: u32) -> u8 {
    let hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ salt;
    ((hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d) >> 24) as u8
}

fn textured(width: usize, height: usize) -> Rgb8 {
    Rgb8::from_fn(width, height, |x, y| {
        [0, 7, 9].map(|salt| 40 + noise(x / 3, y / 2, salt) / 2)
    })
}

/// The metrics of a picture and its clean version.
fn list_metrics() -> Vec<MetricId> {
    MetricId::all()
        .filter(|id| matches!(id.info().needs, Needs::Nothing | Needs::PictureInAir))
        .collect()
}

fn measure_all(picture: &Rgb8, clean: &Rgb8, mask: Option<&Plane<u8>>) -> Vec<(MetricId, f64)> {
    let subject = Subject {
        clean: Some(clean),
        mask,
        ..Subject::new(picture)
    };
    measure_subject(&subject, &list_metrics()).unwrap()
}

fn blurred(picture: &Rgb8) -> Rgb8 {
    Rgb8::from_fn(picture.width(), picture.height(), |x, y| {
        let (one, other) = (picture.pixel(x, y), picture.pixel(x.saturating_sub(1), y));
        [0, 1, 2].map(|i| one[i] / 2 + other[i] / 2)
    })
}

#[test]
fn a_mask_of_the_whole_picture_leaves_every_bit() {
    // Blocks of 4 and of 10 pixels cover the picture.
    for (width, height) in [(120, 80), (20, 8), (1, 1)] {
        let picture = textured(width, height);
        let clean = blurred(&picture);
        let mask = Plane::filled(width, height, 1u8);
        let masked = measure_all(&picture, &clean, Some(&mask));
        for ((id, expected), (_, value)) in measure_all(&picture, &clean, None).iter().zip(&masked) {
            assert_eq!(expected.to_bits(), value.to_bits(), "{id} of {width}×{height}");
        }
    }
}

/// Metrics that read neighbors of the counted pixels: windows, derivatives at the borders of blocks, neighborhoods.
const READ_NEIGHBORS: [&str; 8] = [
    "entropy_2d",
    "uism",
    "uism@funie",
    "uism@table1",
    "uiqm",
    "uiqm@funie",
    "uiqm@table1",
    "ssim",
];

#[test]
fn pixels_outside_of_the_mask_do_not_count() {
    let picture = textured(160, 120);
    let clean = blurred(&picture);
    let mask = Plane::from_fn(160, 120, |x, y| if x < 100 && y >= 20 { 255 } else { 0 });
    let spoil = |picture: &Rgb8, reach: usize| {
        Rgb8::from_fn(160, 120, |x, y| {
            if x < 100 + reach && y + reach >= 20 {
                picture.pixel(x, y)
            } else {
                [noise(x, y, 3), 0, 255]
            }
        })
    };
    let expected = measure_all(&picture, &clean, Some(&mask));
    let spoiled = measure_all(&spoil(&picture, 0), &spoil(&clean, 0), Some(&mask));
    for ((id, expected), (_, value)) in expected.iter().zip(&spoiled) {
        if !READ_NEIGHBORS.contains(&id.to_string().as_str()) {
            assert_eq!(expected.to_bits(), value.to_bits(), "{id}");
        }
    }
    // Five pixels beyond are half a window of ssim.
    let spoiled = measure_all(&spoil(&picture, 5), &spoil(&clean, 5), Some(&mask));
    for ((id, expected), (_, value)) in expected.iter().zip(&spoiled) {
        assert_eq!(expected.to_bits(), value.to_bits(), "{id}");
    }
}

#[test]
fn a_masked_rectangle_measures_like_its_crop() {
    // Pixels, blocks of 4 and of 10, and windows around the pixels.
    let picture = textured(120, 80);
    let mask = Plane::from_fn(120, 80, |x, y| {
        u8::from((20..80).contains(&x) && (20..60).contains(&y))
    });
    let crop = |picture: &Rgb8| Rgb8::from_fn(60, 40, |x, y| picture.pixel(x + 20, y + 20));
    let clean = blurred(&picture);
    let masked = measure_all(&picture, &clean, Some(&mask));
    let cropped = measure_all(&crop(&picture), &crop(&clean), None);
    for ((id, expected), (_, value)) in cropped.iter().zip(&masked) {
        let name = id.to_string();
        // Cells and features depend on the size of the picture.
        let depends_on_size = ["light_uniformity", "features", "features_default"].contains(&name.as_str());
        if !depends_on_size && !READ_NEIGHBORS.contains(&name.as_str()) {
            assert!(
                (expected - value).abs() <= 1e-12 * expected.abs(),
                "{name}: {value} for {expected}"
            );
        }
    }
}

#[test]
fn an_empty_mask_yields_0_for_every_metric() {
    for (width, height) in [(120, 80), (5, 3), (1, 1)] {
        let picture = textured(width, height);
        let mask = Plane::filled(width, height, 0u8);
        for (id, value) in measure_all(&picture, &picture, Some(&mask)) {
            assert_eq!(value.to_bits(), 0f64.to_bits(), "{id} of {width}×{height}");
        }
    }
}

#[test]
fn any_mask_leaves_finite_values() {
    for (width, height) in [(1, 1), (2, 2), (7, 3), (40, 30), (90, 70)] {
        let picture = textured(width, height);
        for period in [2, 7, 31] {
            let mask = Plane::from_fn(width, height, |x, y| u8::from((x + 3 * y) % period == 1));
            for (id, value) in measure_all(&picture, &blurred(&picture), Some(&mask)) {
                assert!(value.is_finite(), "{id} is {value}");
            }
        }
    }
}

#[test]
fn features_near_the_outside_are_dropped() {
    let picture = textured(300, 200);
    let mask = Plane::from_fn(300, 200, |x, _| if x < 150 { 255 } else { 0 });
    let all = quality::FrameFeatures::find(&picture, None);
    let inside = quality::FrameFeatures::find(&picture, Some(&mask));
    assert!(inside.adaptive.count() > 50 && inside.adaptive.count() < all.adaptive.count());
    // Half a patch of 37 pixels at each level.
    for keypoint in &inside.adaptive.keypoints {
        let reach = 18.5 * 1.2f32.powi(i32::from(keypoint.level));
        assert!(keypoint.x < 151.0 - reach, "{keypoint:?}");
    }
}

#[test]
fn a_mask_of_another_size_is_an_error() {
    let picture = textured(20, 10);
    let mask = Plane::filled(20, 11, 255u8);
    let subject = Subject {
        mask: Some(&mask),
        ..Subject::new(&picture)
    };
    let error = measure_subject(&subject, &list_metrics()[..1]).unwrap_err();
    assert!(matches!(error, QualityError::Size { .. }));
    assert_eq!(error.to_string(), "picture is 20×10 but the mask is 20×11");
}
