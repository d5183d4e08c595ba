//! Vignetting: the cosine to the fourth of an ideal lens times a polynomial.
//!
//! `(1 - v + v cos⁴ θ) max(0, 1 + v1 q + v2 q² + v3 q³)` with `cos⁴ θ = 1/(1 + r²/f²)²` (f of the lens in air) and `q`
//! the squared radius relative to that of the farthest corner.

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb, vectorized};
use spec::Vignette;

use crate::rounding;

/// Rings of equal area with separate limits of the factor.
const RINGS: usize = 1024;
/// Relative error of an f64 factor.
const IN_F64: f64 = 32.0 * f64::EPSILON;

/// The fall-off over a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FallOff {
    /// Weight of the cosine, v.
    cosine_weight: f64,
    /// v1, v2 and v3.
    terms: [f64; 3],
    camera: Intrinsics,
    /// Reciprocal of the squared radius of the farthest corner; 0 for a picture of one pixel.
    per_corner: f64,
}

impl FallOff {
    /// The fall-off of a lens in a picture of this size.
    #[must_use]
    pub fn new(law: Vignette, camera: Intrinsics, size: (usize, usize)) -> Self {
        Self::with_terms(law.v, [0.0, law.v2, 0.0], camera, size)
    }

    /// The fall-off with the weight of the cosine and v1, v2 and v3.
    #[must_use]
    pub fn with_terms(
        cosine_weight: f64,
        terms: [f64; 3],
        camera: Intrinsics,
        (width, height): (usize, usize),
    ) -> Self {
        let (x, y) = (farthest(camera.cx, width), farthest(camera.cy, height));
        let square = x * x + y * y;
        Self {
            cosine_weight,
            terms,
            camera,
            per_corner: if square > 0.0 { 1.0 / square } else { 0.0 },
        }
    }

    /// The factor of a pixel.
    #[must_use]
    pub fn factor(&self, x: usize, y: usize) -> f64 {
        let (v, [v1, v2, v3]) = (self.cosine_weight, self.terms);
        let (x, y) = (x as f64 - self.camera.cx, y as f64 - self.camera.cy);
        let r2 = x * x + y * y;
        let stretch = 1.0 + r2 / (self.camera.focal_px * self.camera.focal_px);
        let q = r2 * self.per_corner;
        let rest = 1.0 + q * (v1 + q * (v2 + q * v3));
        (1.0 - v + v / (stretch * stretch)) * rest.max(0.0)
    }

    /// The factor of every pixel in f64.
    #[must_use]
    pub fn reference(&self, (width, height): (usize, usize)) -> Plane<f64> {
        Plane::from_fn(width, height, |x, y| self.factor(x, y))
    }

    /// The factors of a row times a gain.
    pub(crate) fn factors(&self, y: usize, gain: f64, factors: &mut [f32]) {
        vectorized!(row(self, y, gain, &mut *factors));
    }

    /// Limits of the factor in a picture of this size. The largest one is the gain of errors of the light.
    #[must_use]
    pub fn limits(&self, (width, height): (usize, usize)) -> Factors {
        let Intrinsics { cx, cy, .. } = self.camera;
        let (x, y) = (farthest(cx, width), farthest(cy, height));
        let step = (x * x + y * y) / RINGS as f64;
        let mut factors = Factors {
            least: f64::INFINITY,
            largest: 0.0,
        };
        for ring in 0..RINGS {
            let [inner, outer] = [ring, ring + 1].map(|ring| ring as f64 * step);
            let rest = self.rest(inner * self.per_corner, outer * self.per_corner);
            // The cosine falls with the radius.
            factors.least = factors.least.min(self.cosine(outer) * rest.least);
            factors.largest = factors.largest.max(self.cosine(inner) * rest.largest);
        }
        factors
    }

    /// The largest deviation of a factor from 1 in a picture of this size: the largest change of light of radiance 1.
    #[must_use]
    pub fn strength(&self, size: (usize, usize)) -> f64 {
        let Factors { least, largest } = self.limits(size);
        (1.0 - least).max(largest - 1.0)
    }

    /// `1 - v + v cos⁴ θ` at a squared radius.
    fn cosine(&self, r2: f64) -> f64 {
        let stretch = 1.0 + r2 / (self.camera.focal_px * self.camera.focal_px);
        1.0 - self.cosine_weight + self.cosine_weight / (stretch * stretch)
    }

    /// Limits of the polynomial between two values of q.
    fn rest(&self, inner: f64, outer: f64) -> Factors {
        let [v1, v2, v3] = self.terms;
        let q = (inner + outer) / 2.0;
        let middle = 1.0 + q * (v1 + q * (v2 + q * v3));
        let slope = v1.abs() + outer * (2.0 * v2.abs() + outer * 3.0 * v3.abs());
        let away = slope * (outer - inner) / 2.0;
        Factors {
            least: (middle - away).max(0.0),
            largest: (middle + away).max(0.0),
        }
    }
}

/// The distance of the farthest pixel along an axis.
fn farthest(center: f64, side: usize) -> f64 {
    center.max(side as f64 - 1.0 - center)
}

/// Limits of the factors of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// Lower limit.
    pub least: f64,
    /// Upper limit.
    pub largest: f64,
}

/// Largest rounding error of [`expose`] if no exposed sample is larger than `exposed_peak` in magnitude. The error of a
/// sample is relative to its exposed light: for light clipped at white, `exposed_peak` is at most white.
#[must_use]
pub fn rounding_bound(falloff: Option<&FallOff>, gain: f64, exposed_peak: f64) -> f64 {
    if falloff.is_none() && gain == 1.0 {
        return 0.0;
    }
    // One rounding for the factor, one for the product, and the rest of f64.
    rounding::absolute(2.0, exposed_peak) + IN_F64 * exposed_peak
}

/// Multiplies a picture by the fall-off, if any, and by the exposure gain.
pub fn expose(picture: &mut Rgb<f32>, falloff: Option<&FallOff>, gain: f64) {
    let (width, height) = picture.size();
    let Some(falloff) = falloff else {
        for samples in picture.planes_mut() {
            vectorized!(samples.iter_mut().for_each(|v| *v *= gain as f32));
        }
        return;
    };
    let mut factors = vec![0.0f32; width];
    for y in 0..height {
        falloff.factors(y, gain, &mut factors);
        for samples in picture.planes_mut() {
            let samples = &mut samples[y * width..(y + 1) * width];
            vectorized!(multiply(&mut *samples, &factors));
        }
    }
}

/// The factors of a row. f64 is free here and keeps the factor exact to the last bit of f32.
#[inline(always)]
fn row(falloff: &FallOff, y: usize, gain: f64, factors: &mut [f32]) {
    let (v, [v1, v2, v3]) = (falloff.cosine_weight, falloff.terms);
    let Intrinsics { focal_px, cx, cy } = falloff.camera;
    let down = (y as f64 - cy) * (y as f64 - cy);
    let per_focal = 1.0 / (focal_px * focal_px);
    let per_corner = falloff.per_corner;
    for (x, factor) in factors.iter_mut().enumerate() {
        let across = x as f64 - cx;
        let r2 = across * across + down;
        let stretch = 1.0 + r2 * per_focal;
        let q = r2 * per_corner;
        let rest = imaging::simd::larger(1.0 + q * (v1 + q * (v2 + q * v3)), 0.0);
        *factor = (gain * (1.0 - v + v / (stretch * stretch)) * rest) as f32;
    }
}

#[inline(always)]
fn multiply(samples: &mut [f32], factors: &[f32]) {
    for (sample, factor) in samples.iter_mut().zip(factors) {
        *sample *= factor;
    }
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;

    use super::*;

    const SIZE: (usize, usize) = (41, 29);

    fn falloffs() -> impl Iterator<Item = FallOff> {
        let stream = Stream::stage(1, "falloffs");
        (0..200).map(move |case| {
            let unit = |element: u64| stream.unit(case, element);
            let signed = |element: u64| {
                if unit(element + 10) < 0.3 {
                    0.0
                } else {
                    2.0 * unit(element) - 1.0
                }
            };
            let terms = [2, 3, 4].map(signed);
            let (cx, cy) = (40.0 * unit(5), 28.0 * unit(6));
            let focal_px = 5.0 * libm::exp(6.0 * unit(7));
            FallOff::with_terms(
                unit(0).round() * unit(1),
                terms,
                Intrinsics { focal_px, cx, cy },
                SIZE,
            )
        })
    }

    #[test]
    fn no_factor_is_beyond_the_limits_and_some_is_near() {
        for falloff in falloffs() {
            let all = falloff.reference(SIZE);
            let samples = || all.data().iter().copied();
            let (least, largest) = (
                samples().fold(f64::INFINITY, f64::min),
                samples().fold(0.0, f64::max),
            );
            let limits = falloff.limits(SIZE);
            assert!(limits.least <= least && largest <= limits.largest, "{falloff:?}");
            // Pixels are up to a few hundredths of the radius apart.
            assert!(
                limits.least > least - 0.2 && limits.largest < largest + 0.2,
                "{falloff:?}"
            );
            let strength = falloff.strength(SIZE);
            assert!(
                samples().all(|factor| (1.0 - factor).abs() <= strength),
                "{falloff:?}"
            );
        }
    }

    #[test]
    fn exposed_light_errs_by_two_roundings() {
        let stream = Stream::stage(2, "exposed");
        let mut nearest = 0.0f64;
        for (case, falloff) in falloffs().enumerate() {
            let (case, falloff) = (case as u64, (case % 3 > 0).then_some(falloff));
            let gain = libm::exp(14.0 * stream.unit(case, 0) - 7.0);
            let peak = libm::exp(-20.0 * stream.unit(case, 1));
            let light = Rgb::from_fn(SIZE.0, SIZE.1, |x, y| {
                [2, 3, 4].map(|k| (peak * stream.unit(case, (k + 5 * (x + 64 * y)) as u64)) as f32)
            });
            let mut fast = light.clone();
            expose(&mut fast, falloff.as_ref(), gain);
            for y in 0..SIZE.1 {
                for x in 0..SIZE.0 {
                    let factor = falloff.map_or(1.0, |falloff| falloff.factor(x, y));
                    for (light, fast) in light.pixel(x, y).into_iter().zip(fast.pixel(x, y)) {
                        let exact = f64::from(light) * gain * factor;
                        let bound = rounding_bound(falloff.as_ref(), gain, exact);
                        let error = (f64::from(fast) - exact).abs();
                        assert!(error <= bound, "{error:e} of {bound:e}");
                        nearest = nearest.max(error / bound);
                    }
                }
            }
        }
        assert!(nearest > 0.7, "{nearest}");
    }
}
