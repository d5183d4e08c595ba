//! Light that falls off towards the corners: the cosine to the fourth of an ideal lens, and a polynomial for the rest.
//!
//! `(1 - v + v cos⁴ θ) max(0, 1 + v1 q + v2 q² + v3 q³)` with `cos⁴ θ = 1/(1 + r²/f²)²` (f of the lens in air) and `q` the
//! square of the radius over that of the farthest corner.

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb, vectorized};
use spec::Vignette;

/// The fall-off over a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FallOff {
    law: Vignette,
    camera: Intrinsics,
    /// 1 over the square of the radius of the farthest corner; 0 in a picture of one pixel.
    per_corner: f64,
}

impl FallOff {
    /// That of a lens whose picture has these sides.
    #[must_use]
    pub fn new(law: Vignette, camera: Intrinsics, (width, height): (usize, usize)) -> Self {
        let far = |center: f64, side: usize| center.max(side as f64 - 1.0 - center);
        let (x, y) = (far(camera.cx, width), far(camera.cy, height));
        let square = x * x + y * y;
        Self {
            law,
            camera,
            per_corner: if square > 0.0 { 1.0 / square } else { 0.0 },
        }
    }

    /// The factor of a pixel.
    #[must_use]
    pub fn factor(&self, x: usize, y: usize) -> f64 {
        let Vignette { v, v1, v2, v3 } = self.law;
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

    /// The factors of a row, times a gain.
    pub(crate) fn factors(&self, y: usize, gain: f64, factors: &mut [f32]) {
        vectorized!(row(self, y, gain, &mut *factors));
    }

    /// The largest way of a factor from 1 in a picture of these sides: the largest change of light of radiance 1.
    #[must_use]
    pub fn strength(&self, (width, height): (usize, usize)) -> f64 {
        // Along a radius the factor is smooth; a sixteenth of the picture is a dense enough walk.
        let steps = |side: usize| (0..=16).map(move |i| i * (side - 1) / 16);
        let all = steps(height).flat_map(|y| steps(width).map(move |x| (x, y)));
        all.map(|(x, y)| (1.0 - self.factor(x, y)).abs())
            .fold(0.0, f64::max)
    }
}

/// Multiplies a picture by the fall-off, if there is one, and by the gain of its exposure.
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

/// The factors of a row. Doubles cost nothing here and keep the factor exact to a last bit of f32.
#[inline(always)]
fn row(falloff: &FallOff, y: usize, gain: f64, factors: &mut [f32]) {
    let Vignette { v, v1, v2, v3 } = falloff.law;
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
