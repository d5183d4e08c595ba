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
mod guide;
mod reference;

use imaging::Plane;

use crate::variant::Variant;
pub use guide::{Guide, RADIUS_MAX, RADIUS_PX, REGULARIZATION};
pub(in crate::blocks) use reference::box_mean;

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

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::guide::solve;
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
