//! Error bound of sampling a picture in f32 along the fast map.

use super::map::SourcePicture;
use crate::rounding;

/// Largest difference in direction between the fast map and its reference, in focal lengths of the source picture. Both
/// inverses stop after a step below `ARRIVED`; if they converge within `MOST_STEPS` steps, the rest is less than twice
/// that.
const DIRECTION: f64 = 1e-12;
/// Rounding of an f64 position, in units of the side of the source picture.
const PLACE_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Largest difference in pixels between [`super::coordinates`] and [`super::coordinates_reference`], along rows or
/// columns.
#[must_use]
pub fn place_bound_px(source: &SourcePicture) -> f64 {
    let side = source.size.0.max(source.size.1) as f64;
    DIRECTION * source.camera.focal_px + PLACE_ROUNDING * side
}

/// Largest error of [`super::Sampling::picture`] along the fast map against [`super::resample_reference`] along the
/// reference.
///
/// No sample of the source picture is larger than `peak` in magnitude; neighbors differ by at most `difference`, which
/// is at most `peak` without negative light. Bilinear weights are at least 0 and sum to 1 for any supersampling: the
/// gain is 1.
#[must_use]
pub fn sampling_bound(source: &SourcePicture, peak: f64, difference: f64) -> f64 {
    // `a + (b - a) x` twice in a row: each rounds the sum once, the difference, its product and half of it for x.
    let rounded = rounding::absolute(2.0, peak) + rounding::absolute(5.0, difference);
    rounded + 2.0 * place_bound_px(source) * difference
}

#[cfg(test)]
mod tests {
    use imaging::geometry::Intrinsics;
    use imaging::random::Stream;
    use imaging::{Plane, Rgb};
    use spec::Distortion;

    use super::super::{
        Lens, PortRefraction, Sampling, SourcePicture, coordinates, coordinates_reference, resample_reference,
    };
    use super::*;

    const SIZE: (usize, usize) = (53, 37);

    fn lenses() -> Vec<Lens> {
        let distortion = |k1, k2, p1| Distortion {
            k1,
            k2,
            p1,
            ..Distortion::default()
        };
        let distortions = [
            distortion(0.0, 0.0, 0.0),
            distortion(-0.25, 0.05, 0.01),
            distortion(0.4, 0.0, -0.02),
        ];
        let refractions = [
            PortRefraction::None,
            PortRefraction::Flat {
                index: [1.33, 1.34, 1.35],
            },
        ];
        let focals = [25.0, 60.0, 5000.0];
        let all = focals.into_iter().flat_map(move |focal_px| {
            let camera = Intrinsics::centered(focal_px, SIZE.0, SIZE.1);
            distortions.into_iter().flat_map(move |distortion| {
                refractions.into_iter().map(move |refraction| Lens {
                    camera,
                    distortion,
                    refraction,
                })
            })
        });
        all.filter(|lens| lens.check(SIZE).is_ok()).collect()
    }

    /// Pictures with full-range steps between neighbors, and nearly uniform ones.
    fn scenes(size: (usize, usize)) -> Vec<(Rgb<f32>, f64)> {
        let stream = Stream::stage(5, "scenes");
        let unit = |x: usize, y: usize, c: usize| stream.unit((c + 3 * x) as u64, y as u64) as f32;
        let make = |sample: &dyn Fn(usize, usize, usize) -> f32| {
            Rgb::from_fn(size.0, size.1, |x, y| [0, 1, 2].map(|c| sample(x, y, c)))
        };
        vec![
            (make(&|x, y, _| ((x + y) % 2) as f32), 1.0),
            (make(&unit), 1.0),
            (make(&|x, y, c| 1.0 - 0.3 * unit(x, y, c)), 0.3),
            (make(&|x, y, c| 1.0 - 1e-4 * unit(x, y, c)), 1e-4),
            (
                make(&|x, y, _| f32::from((x, y) == (size.0 / 2, size.1 / 2))),
                1.0,
            ),
            (make(&|x, y, c| 1e-39 * unit(x, y, c)), 1e-39),
        ]
    }

    #[test]
    fn samples_err_by_no_more_than_their_bound() {
        let mut nearest = 0.0f64;
        for lens in lenses() {
            for supersample in [1, 2, 3] {
                let source = SourcePicture::covering(&lens, SIZE, supersample).unwrap();
                let maps = coordinates(&lens, &source, SIZE);
                let sampling = Sampling::new(&maps, source.size);
                let references = [0, 1, 2].map(|c| coordinates_reference(&lens, &source, SIZE, c));
                for (channel, reference) in references.iter().enumerate() {
                    let map = maps.get(channel).unwrap_or(&maps[0]);
                    let largest_difference = |a: &Plane<f64>, b: &Plane<f64>| {
                        let pairs = a.data().iter().zip(b.data());
                        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                    };
                    let places = largest_difference(&map.x, &reference.x)
                        .max(largest_difference(&map.y, &reference.y));
                    assert!(places <= place_bound_px(&source), "{places:e} of {lens:?}");
                }
                for (scene, difference) in scenes(source.size) {
                    let fast = sampling.picture(&scene);
                    let peak = f64::from(scene.planes()[0].data().iter().copied().fold(0.0, f32::max));
                    let bound = sampling_bound(&source, peak.max(difference), difference);
                    for (channel, reference) in references.iter().enumerate() {
                        let wide = scene.planes()[channel].map(|&v| f64::from(v));
                        let exact = resample_reference(&wide, reference);
                        let pairs = exact.data().iter().zip(fast.planes()[channel].data());
                        let errors = pairs.map(|(e, f)| (e - f64::from(*f)).abs());
                        let error = errors.fold(0.0, f64::max);
                        assert!(error <= bound, "{error:e} of {bound:e}: {lens:?}");
                        nearest = nearest.max(error / bound);
                    }
                }
            }
        }
        assert!(nearest > 0.2, "{nearest}");
    }
}
