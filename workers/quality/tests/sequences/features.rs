//! Features and matches: invariance, agreement with a published program, and hard pictures.

use imaging::{Plane, Rgb8};
use quality::{FEATURE_BUDGET, FrameFeatures, Motion, Threshold, match_features};

use crate::room::Camera;

fn find(picture: &Rgb8) -> FrameFeatures {
    FrameFeatures::find(picture, None)
}

/// Matches and correct matches of neighboring frames along the path.
fn count_matches(contrast: f64, threshold: Threshold) -> (usize, usize) {
    let cameras: Vec<Camera> = (0..5).map(Camera::on_path).collect();
    let frames: Vec<FrameFeatures> = cameras
        .iter()
        .map(|camera| find(&camera.render(contrast, 120.0, 4.0)))
        .collect();
    let (mut all, mut correct) = (0, 0);
    for i in 1..5 {
        let motion = cameras[i].motion_from(&cameras[i - 1]);
        let (current, previous) = (
            frames[i].with_threshold(threshold),
            frames[i - 1].with_threshold(threshold),
        );
        let matches = match_features(current, previous);
        correct += motion.correct_matches(current, previous, &matches).len();
        all += matches.len();
    }
    (all, correct)
}

/// The same pictures by ORB of OpenCV 4 (1000 features, eight levels, a margin of 18 px) and its cross-checked matcher
/// without a largest distance. The patterns of the descriptors differ, and OpenCV has no corners of equal neighbors, which
/// are many in a pale picture.
#[test]
fn matches_are_as_many_as_those_of_opencv() {
    // Threshold 20.
    let (all, correct) = count_matches(240.0, Threshold::Default);
    assert!(all.abs_diff(2730) < 2730 / 10, "{all}");
    assert!(correct.abs_diff(2586) < 2586 / 10, "{correct}");
    assert_eq!(count_matches(60.0, Threshold::Default), (0, 0));
    // Threshold 1.
    let (all, correct) = count_matches(60.0, Threshold::Adaptive);
    assert!(all.abs_diff(2259) < 2259 / 5, "{all}");
    assert!(correct.abs_diff(1965) < 1965 / 5, "{correct}");
}

#[test]
fn brightness_leaves_every_feature_and_contrast_nearly_all() {
    let picture = Camera::on_path(0).render(50.0, 60.0, 2.0);
    let features = find(&picture);
    assert_eq!(features.adaptive.count(), FEATURE_BUDGET);
    let change = |gain: u8, offset: u8| {
        Rgb8::from_fn(picture.width(), picture.height(), |x, y| {
            picture.pixel(x, y).map(|code| gain * code + offset)
        })
    };
    // Equality without a list of all features on failure.
    assert!(find(&change(1, 100)) == features);
    let contrasted = find(&change(2, 30));
    assert_eq!(contrasted.adaptive.count(), FEATURE_BUDGET);
    // Levels above the first are rounded.
    let [whole, contrasted_whole] = [&features, &contrasted].map(|features| list_positions(features, 0));
    assert_eq!(whole, contrasted_whole);
    let [all, contrasted_all] = [&features, &contrasted].map(|features| list_positions(features, 7));
    let common = all
        .iter()
        .filter(|position| contrasted_all.contains(position))
        .count();
    assert!(common > 700, "{common}");
    // The default threshold depends on the contrast.
    let [count, contrasted_count] = [&features, &contrasted].map(|features| features.default.count());
    assert!(count == 0 && contrasted_count > 30, "{count} {contrasted_count}");
}

/// Positions of the adaptive features up to a level.
fn list_positions(features: &FrameFeatures, level: u8) -> Vec<(f32, f32)> {
    let keypoints = features.adaptive.keypoints.iter();
    keypoints
        .filter(|keypoint| keypoint.level <= level)
        .map(|keypoint| (keypoint.x, keypoint.y))
        .collect()
}

#[test]
fn levels_of_enough_contrast_have_the_same_features_at_both_thresholds() {
    let FrameFeatures { adaptive, default } = find(&Camera::on_path(0).render(240.0, 120.0, 0.0));
    let count = adaptive
        .keypoints
        .iter()
        .filter(|keypoint| keypoint.level < 3)
        .count();
    assert!(count > 500 && adaptive.keypoints[..count] == default.keypoints[..count]);
    assert!(adaptive.descriptors[..count] == default.descriptors[..count]);
}

#[test]
fn a_turned_picture_matches() {
    let picture = Camera::on_path(0).render(240.0, 120.0, 0.0);
    let (width, height) = (picture.width(), picture.height());
    // Pixel (x, y) of the turned picture shows (y, height - 1 - x).
    let turned = Rgb8::from_fn(height, width, |x, y| picture.pixel(y, height - 1 - x));
    let motion = Motion {
        positions: Plane::from_fn(height, width, |x, y| {
            [y as f32 + 0.5, (height - 1 - x) as f32 + 0.5]
        }),
    };
    let (current, previous) = (find(&turned).adaptive, find(&picture).adaptive);
    let matches = match_features(&current, &previous);
    let correct = motion.correct_matches(&current, &previous, &matches);
    assert!(
        correct.len() > 600 && correct.len() * 20 > matches.len() * 19,
        "{}",
        correct.len()
    );
}

#[test]
fn hard_pictures_have_no_features_or_finite_ones() {
    let noise = |x: usize, y: usize| (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77)) as u32;
    for (width, height) in [(1, 1), (2, 2), (7, 3), (36, 36), (37, 37), (200, 40)] {
        for code in [0, 128, 255] {
            assert_eq!(
                find(&Rgb8::from_fn(width, height, |_, _| [code; 3])),
                FrameFeatures::default()
            );
        }
        let features = find(&Rgb8::from_fn(width, height, |x, y| {
            [(noise(x, y) >> 13) as u8; 3]
        }));
        for keypoint in &features.adaptive.keypoints {
            assert!((0.0..width as f32).contains(&keypoint.x) && (0.0..height as f32).contains(&keypoint.y));
            assert!(keypoint.response.is_finite());
        }
    }
    // Sixteen megapixels of the weakest texture: nearly every corner has the same score.
    let weak = Rgb8::from_fn(4096, 4096, |x, y| {
        [((noise(x, y).wrapping_mul(0x2c1b_3c6d)) >> 31) as u8; 3]
    });
    let features = find(&weak);
    assert_eq!(
        (features.adaptive.count(), features.default.count()),
        (FEATURE_BUDGET, 0)
    );
}
