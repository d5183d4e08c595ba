//! A network with a range keeps contrast near, loses it far away, and estimates range from the veil of photos.

#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::{Plane, transfer};
use optics::chain;
use optics::medium::{Ambient, Medium};
use optics::water::Water;
use spec::Optics;
use style::Library;
use style::net::onnx;
use training::{Photo, contrast_kept};

/// Minimum ratio of kept near contrast to kept far contrast.
const LEAST_RATIO: f64 = 2.0;

#[test]
fn near_keeps_twice_the_contrast_of_far_and_that_comes_from_the_range() {
    let library = Library::embedded().unwrap();
    let weights = onnx::read(&library.get("atlantic-range").unwrap().onnx).unwrap();
    let kept = contrast_kept(&weights, Plane::clone);
    assert!(kept.near >= LEAST_RATIO * kept.far, "{kept:?}");
    // Same range everywhere: near and far parts must be treated equally.
    let even = contrast_kept(&weights, |range| {
        Plane::filled(range.width(), range.height(), 3.0)
    });
    assert!(even.near < 1.3 * even.far, "{even:?}");
    // A network without a range.
    let blind = onnx::read(&library.get("atlantic").unwrap().onnx).unwrap();
    let kept = contrast_kept(&blind, Plane::clone);
    assert!(kept.near < LEAST_RATIO * kept.far, "{kept:?}");
}

/// The photos of `models/photos/atlantic-range.json` without patches and blur, and their ranges.
fn photo(seed: u64) -> (Photo, Plane<f32>) {
    let (width, height) = (240, 180);
    let focal_px = 0.714 * width as f64;
    let lens = Intrinsics::centered(focal_px, width, height);
    let scene = scenes::procedural("structure", seed, width, height, lens).unwrap();
    let optics = Optics {
        beam_attenuation_per_m: Some([1.0, 0.42, 0.4]),
        diffuse_attenuation_per_m: Some([0.31465, 0.09875, 0.09245]),
        veiling_light: Some([0.012, 0.085, 0.165]),
        ..Optics::default()
    };
    let medium = Medium {
        depth_m: Some(6.0),
        ambient: Ambient::Exposed,
        ..optics.into()
    };
    let water = Water::resolve(&medium, focal_px).unwrap();
    let radiance = scene.radiance.map(|&light| f64::from(light));
    let range = scene.range.unwrap();
    let doubled = range.map(|&range| f64::from(range));
    let layers = chain::water_reference(&radiance, &doubled, &water).unwrap();
    let shown = layers.scattered.map(|&light| light as f32);
    let photo = Photo::new(&transfer::encode_rgb8(&shown).0).unwrap();
    (photo, optics::attenuation::faded(&range, style::RANGE_SCALE_M))
}

/// Minimum rank correlation of the estimate with the range: 1 is perfect order, 0 is chance. Thin struts far apart are
/// the hardest: the water around them counts as equally near.
const LEAST_CORRELATION: f64 = 0.4;

#[test]
fn the_veil_of_a_photo_tells_near_from_far() {
    for seed in [8, 15, 21] {
        let (photo, range) = photo(seed);
        let correlation = pearson(&ranks(&photo.range().data), &ranks(range.data()));
        assert!(correlation > LEAST_CORRELATION, "{seed}: {correlation:.2}");
    }
}

/// The rank of each value; ties share the mean of their ranks.
fn ranks(values: &[f32]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let first = order.partition_point(|&at| values[at] < values[equal[0]]);
        let rank = first as f64 + (equal.len() - 1) as f64 / 2.0;
        equal.iter().for_each(|&at| ranks[at] = rank);
    }
    ranks
}

fn pearson(one: &[f64], other: &[f64]) -> f64 {
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let (a, b) = (mean(one), mean(other));
    let product: f64 = one.iter().zip(other).map(|(x, y)| (x - a) * (y - b)).sum();
    let square = |of: &[f64], mean: f64| of.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    product / (square(one, a) * square(other, b)).sqrt()
}
