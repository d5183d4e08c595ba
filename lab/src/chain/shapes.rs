//! Sizes, holes, threads.

use imaging::{Plane, Rgb};
use optics::chain::check_radiance;
use optics::forward_scatter::KernelCache;
use spec::{HoleRule, ScatterModel};

use super::finding::Finding;
use super::trial::{DEFAULT, TOLERANCE, Trial, coastal, coastal_at, noise};
use crate::parallel::run_all;
use crate::statistics::largest;

/// The largest error over sizes and both models.
fn worst_error(sizes: &[(usize, usize)]) -> f64 {
    let models = [ScatterModel::Jaffe, ScatterModel::Simplified];
    let trials = sizes
        .iter()
        .flat_map(|&size| models.map(|model| Trial::on_slope(size, [0.5, 20.0], coastal(model, 1.0))));
    largest(trials.map(|trial| trial.error(DEFAULT)))
}

/// Frames one or a few pixels wide or high.
pub(super) fn measure_single_pixels() -> Finding {
    let sizes = [(1, 1), (1, 2), (2, 1), (1, 97), (97, 1), (2, 2), (3, 1)];
    Finding::default().at_most("error", worst_error(&sizes), TOLERANCE)
}

/// Sizes without a fast transform.
pub(super) fn measure_prime_sizes() -> Finding {
    let prime = worst_error(&[(127, 97), (61, 53), (31, 2), (17, 13)]);
    let composite = worst_error(&[(128, 96), (60, 54)]);
    Finding::default()
        .at_most("error, prime sides", prime, TOLERANCE)
        .at_most("error, composite sides", composite, TOLERANCE)
}

/// A slope with a third of the pixels as holes of a kind.
fn holes_trial(size: (usize, usize), rule: HoleRule, kind: f32) -> Trial {
    let mut trial = Trial::on_slope(size, [1.0, 12.0], coastal_at(None, rule));
    let slope = trial.range.clone();
    trial.range = Plane::from_fn(size.0, size.1, |x, y| {
        let is_hole = (x / (size.0 / 9) + y / (size.0 / 9)).is_multiple_of(3);
        if is_hole { kind } else { slope.pixel(x, y) }
    });
    trial
}

fn samples(image: &Rgb<f32>) -> impl Iterator<Item = f32> + '_ {
    let planes = image.planes().iter();
    planes.flat_map(|plane| plane.data().iter().copied())
}

/// Invalid ranges.
pub(super) fn measure_holes() -> Finding {
    let size = (48, 32);
    let kinds = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -3.0, 5e-4];
    let images = kinds.map(|kind| {
        let trial = holes_trial(size, HoleRule::Background, kind);
        trial.render(DEFAULT).scattered
    });
    let differing: usize = images
        .iter()
        .map(|image| samples(image).zip(samples(&images[0])))
        .map(|pairs| pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count())
        .sum();
    let no_number = images.iter().flat_map(samples).filter(|v| !v.is_finite()).count();
    let mut all = holes_trial(size, HoleRule::Background, 0.0);
    all.range = Plane::filled(size.0, size.1, f32::NAN);
    let errors = [HoleRule::Background, HoleRule::RangeM(8.0)]
        .map(|rule| holes_trial(size, rule, f32::NAN).error(DEFAULT));
    Finding::default()
        .at_most("error", largest(errors), TOLERANCE)
        .at_most("samples that are no number", no_number as f64, 0.0)
        .at_most("samples that differ by kind", differing as f64, 0.0)
        .at_most("error of a frame of holes", all.error(DEFAULT), TOLERANCE)
}

/// Invalid radiance.
pub(super) fn measure_bad_radiance() -> Finding {
    let size = (13, 7);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter();
    let refused = bad.filter(|bad| {
        let mut radiance = noise(size);
        radiance.planes_mut()[2][40] = *bad;
        check_radiance(&mut radiance)
            .is_err_and(|error| error.to_string().contains("channel B of pixel (1, 3)"))
    });
    let mut negative = noise(size).map(|&v| v - 0.5);
    let below = samples(&negative).filter(|v| *v < 0.0).count();
    let counted = check_radiance(&mut negative).unwrap_or(0);
    Finding::default()
        .at_least("rejected with the pixel named, of 3", refused.count() as f64, 3.0)
        .at_most("uncounted negative samples", below as f64 - counted as f64, 0.0)
}

/// The same frames rendered by one thread and by several, each in another order with the buffers of its previous frame.
pub(super) fn measure_threads() -> Finding {
    let frames: [Trial; 8] = std::array::from_fn(|index| {
        let (size, farthest_m) = ((20 + 7 * index, 41), 5.0 + index as f32);
        Trial::on_slope(size, [0.5, farthest_m], coastal(ScatterModel::Jaffe, 1.0))
    });
    let alone = frames.each_ref().map(|frame| frame.render(DEFAULT).scattered);
    let mut differing = 0;
    for threads in [2, 4, 8] {
        let order: Vec<usize> = (0..8 * threads).map(|step| step * 3 % 8).collect();
        let differs = run_all("", Some(threads), &order, KernelCache::new, |&index, cache| {
            let layers = frames[index].render_with(DEFAULT, cache);
            let differs = layers.scattered != alone[index];
            cache.recycle(layers);
            differs
        });
        differing += differs.iter().filter(|differs| **differs).count();
    }
    Finding::default().at_most("pictures that differ in any bit", differing as f64, 0.0)
}
