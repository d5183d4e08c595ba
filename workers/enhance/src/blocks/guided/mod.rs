//! The guided filter with a color guide (He, Sun and Tang 2013, "Guided image filtering", eq. 14 and 19-21).
//!
//! In each window the output is an affine function of the guide, `q = a · I + b`, with `a = (Σ + ε E)⁻¹ cov(I, p)` and
//! `b = mean(p) - a · mean(I)`; every pixel uses the mean of a and of b over the windows that contain it. `I` is the
//! guide, a color in 0..=1; `p` the plane to filter; `Σ` the 3 × 3 covariance of the guide in the window; means are
//! over windows clipped to the picture. `Σ + ε E` is positive definite, so its determinant is never 0.
//!
//! An offset of the guide does not change the result, and a scale of the guide is a scale of ε: the fast variant works
//! on codes, whose sums are exact integers.

mod fast;
mod reference;

use imaging::{Plane, Rgb8};

use crate::variant::Variant;

/// Radius of the methods' windows, pixels.
pub const RADIUS_PX: usize = 50;
/// ε of the methods, in squares of the guide's 0..=1.
pub const REGULARIZATION: f64 = 1e-3;
/// Largest radius: the fast variant keeps a row of coefficients for each row of a window.
pub const RADIUS_MAX: usize = 255;

/// A guide: codes and their scale.
#[derive(Debug, Clone)]
pub struct Guide {
    channels: [Plane<u8>; 3],
    /// `I = scale · code + offset`; the offset cancels out.
    scale: f64,
    radius_px: usize,
    regularization: f64,
}

impl Guide {
    /// The picture as guide, `I = code / 255`, with the methods' radius and ε.
    #[must_use]
    pub fn new(picture: &Rgb8) -> Self {
        Self {
            channels: picture.to_planes(),
            scale: 1.0 / 255.0,
            radius_px: RADIUS_PX,
            regularization: REGULARIZATION,
        }
    }

    /// Sets the scale of `I = scale · code + offset`, above 0.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Sets the radius, clamped to 0..=[`RADIUS_MAX`], and ε, above 0.
    #[must_use]
    pub fn window(self, radius_px: usize, regularization: f64) -> Self {
        Self {
            radius_px: radius_px.min(RADIUS_MAX),
            regularization,
            ..self
        }
    }

    /// The larger of green and blue.
    pub(crate) fn brighter(&self) -> Plane<u8> {
        let [_, green, blue] = &self.channels;
        let mut brighter = green.clone();
        for (code, &blue) in brighter.data_mut().iter_mut().zip(blue.data()) {
            *code = (*code).max(blue);
        }
        brighter
    }

    /// The planes of red, green and blue.
    #[must_use]
    pub fn channels(&self) -> &[Plane<u8>; 3] {
        &self.channels
    }
}

/// Filters a plane of the guide's size.
///
/// # Panics
/// If the sizes differ.
#[must_use]
pub fn guided(guide: &Guide, plane: &Plane<f64>, variant: Variant) -> Plane<f64> {
    assert_eq!(
        guide.channels[0].size(),
        plane.size(),
        "the guide has the plane's size"
    );
    match variant {
        Variant::Fast => fast::guided(guide, plane),
        Variant::Reference => reference::guided(guide, plane),
    }
}

/// `M⁻¹ v` of a symmetric 3 × 3 matrix, given as `[11, 12, 13, 22, 23, 33]`, by its adjugate.
#[inline(always)]
fn solve([m11, m12, m13, m22, m23, m33]: [f64; 6], [v1, v2, v3]: [f64; 3]) -> [f64; 3] {
    let a11 = m22 * m33 - m23 * m23;
    let a12 = m13 * m23 - m12 * m33;
    let a13 = m12 * m23 - m13 * m22;
    let a22 = m11 * m33 - m13 * m13;
    let a23 = m12 * m13 - m11 * m23;
    let a33 = m11 * m22 - m12 * m12;
    let inverse = 1.0 / (m11 * a11 + m12 * a12 + m13 * a13);
    [
        (a11 * v1 + a12 * v2 + a13 * v3) * inverse,
        (a12 * v1 + a22 * v2 + a23 * v3) * inverse,
        (a13 * v1 + a23 * v2 + a33 * v3) * inverse,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn textured(width: usize, height: usize) -> Rgb8 {
        Rgb8::from_fn(width, height, |x, y| {
            [(37 * x + 11 * y) as u8, (5 * x + 91 * y) as u8, (x * y) as u8]
        })
    }

    #[test]
    fn the_inverse_times_the_matrix_is_one() {
        let [x, y, z] = solve([4.0, 1.0, 0.5, 3.0, -0.25, 2.0], [5.5, 3.75, 2.25]);
        for (got, expected) in [(x, 1.0), (y, 1.0), (z, 1.0)] {
            assert!((got - expected).abs() < 1e-15, "{got}");
        }
    }

    #[test]
    fn a_flat_guide_leaves_two_box_means() {
        let flat = Guide::new(&Rgb8::from_fn(30, 20, |_, _| [9, 80, 200])).window(3, 1e-3);
        let plane = Plane::from_fn(30, 20, |x, y| (x * y % 7) as f64);
        let mean = |plane| reference::box_mean(plane, 3);
        let expected = mean(&mean(&plane));
        for variant in [Variant::Fast, Variant::Reference] {
            for (got, expected) in guided(&flat, &plane, variant).data().iter().zip(expected.data()) {
                assert!((got - expected).abs() < 1e-12, "{got} for {expected}");
            }
        }
    }

    #[test]
    fn an_affine_function_of_the_guide_comes_back_when_nothing_is_regularized() {
        let picture = textured(40, 30);
        let plane = Plane::from_fn(40, 30, |x, y| {
            let [r, g, b] = picture.pixel(x, y).map(f64::from);
            0.3 + (2.0 * r - g + 0.5 * b) / 255.0
        });
        let guide = Guide::new(&picture).window(8, 1e-12);
        for variant in [Variant::Fast, Variant::Reference] {
            for (got, expected) in guided(&guide, &plane, variant).data().iter().zip(plane.data()) {
                assert!((got - expected).abs() < 1e-5, "{got} for {expected}");
            }
        }
    }

    #[test]
    fn an_offset_of_the_guide_changes_nothing() {
        let low = Rgb8::from_fn(25, 25, |x, y| textured(25, 25).pixel(x, y).map(|code| code / 2));
        let high = Rgb8::from_fn(25, 25, |x, y| low.pixel(x, y).map(|code| code + 100));
        let plane = Plane::from_fn(25, 25, |x, y| ((x * 7 + y * y) % 11) as f64);
        let filtered = |picture| guided(&Guide::new(picture), &plane, Variant::Fast);
        for (a, b) in filtered(&low).data().iter().zip(filtered(&high).data()) {
            assert!((a - b).abs() < 1e-5);
        }
    }
}
