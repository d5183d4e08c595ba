//! SSIM against a clean picture, on gray codes (Wang, Bovik, Sheikh and Simoncelli 2004).
//!
//! `SSIM = mean of (2 μ_x μ_y + C1)(2 σ_xy + C2) / ((μ_x² + μ_y² + C1)(σ_x² + σ_y² + C2))` over windows of 11 × 11 with
//! Gaussian weights, σ = 1.5 px; `C1 = (0.01 · 255)²`, `C2 = (0.03 · 255)²`; moments are weighted means.
//!
//! Border: only complete windows count. A picture with a side below 11 has none; there every pixel has a window, and
//! both pictures are extended by reflection without repeating the edge.

use std::borrow::Cow;

use imaging::{Plane, cancel, reflected, vectorized};

use crate::work::{Gray, MetricInput};

const WINDOW_PX: usize = 11;
const RADIUS_PX: usize = WINDOW_PX / 2;
const SIGMA_PX: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Structural similarity, -1..=1.
pub(crate) fn ssim(work: &MetricInput) -> f64 {
    let (x, y) = (work.part::<Gray>(), work.clean().to_gray8());
    let is_extended = x.0.size() != extended(&x.0).size();
    let centers = work.mask().map(|mask| Centers {
        mask,
        first: if is_extended { 0 } else { RADIUS_PX },
    });
    let (x, y) = (extended(&x.0), extended(&y));
    vectorized!(separable(&x, &y, centers.as_ref()))
}

/// The definition, window by window: the reference of the fast variant.
///
/// # Panics
/// If the planes differ in size or are empty.
#[must_use]
pub fn ssim_reference(x: &Plane<u8>, y: &Plane<u8>) -> f64 {
    assert_eq!(x.size(), y.size(), "planes to compare are of one size");
    assert!(!x.data().is_empty(), "a plane to compare has a pixel");
    let (x, y) = (extended(x), extended(y));
    let weights = weights();
    let (columns, rows) = (x.width() - 2 * RADIUS_PX, x.height() - 2 * RADIUS_PX);
    let mut sum = 0.0;
    for top in 0..rows {
        for left in 0..columns {
            let mut moments = WindowMoments::default();
            for (j, down) in weights.iter().enumerate() {
                for (i, across) in weights.iter().enumerate() {
                    let (a, b) = (
                        f64::from(x.pixel(left + i, top + j)),
                        f64::from(y.pixel(left + i, top + j)),
                    );
                    moments.x += across * down * a;
                    moments.y += across * down * b;
                    moments.squares += across * down * (a * a + b * b);
                    moments.product += across * down * (a * b);
                }
            }
            sum += moments.similarity();
        }
    }
    sum / (columns * rows) as f64
}

/// Weighted means of x, y, x² + y² and x y over one window.
#[derive(Default)]
struct WindowMoments {
    x: f64,
    y: f64,
    squares: f64,
    product: f64,
}

impl WindowMoments {
    #[inline(always)]
    fn similarity(&self) -> f64 {
        let (mean_product, mean_squares) = (self.x * self.y, self.x * self.x + self.y * self.y);
        let (covariance, variances) = (self.product - mean_product, self.squares - mean_squares);
        ((2.0 * mean_product + C1) * (2.0 * covariance + C2)) / ((mean_squares + C1) * (variances + C2))
    }
}

/// The windows that count.
struct Centers<'a> {
    mask: &'a Plane<u8>,
    /// Column and row of the first window's center in the mask.
    first: usize,
}

/// The fast variant: down the columns, then along the rows. 0 if no window counts.
#[inline(always)]
fn separable(picture: &Plane<u8>, clean: &Plane<u8>, centers: Option<&Centers>) -> f64 {
    let weights = weights();
    let (width, height) = picture.size();
    let (columns, rows) = (width - 2 * RADIUS_PX, height - 2 * RADIUS_PX);
    let [mut x, mut y, mut squares, mut product] = [const { Vec::new() }; 4];
    let mut similarities = vec![0.0; columns];
    let (mut sum, mut count) = (0.0, 0);
    for top in 0..rows {
        cancel::check();
        for line in [&mut x, &mut y, &mut squares, &mut product] {
            line.clear();
            line.resize(width, 0.0f64);
        }
        for (j, &weight) in weights.iter().enumerate() {
            let codes = picture.row(top + j).iter().zip(clean.row(top + j));
            let sums = x.iter_mut().zip(&mut y).zip(squares.iter_mut().zip(&mut product));
            for ((&a, &b), ((x, y), (squares, product))) in codes.zip(sums) {
                let (a, b) = (f64::from(a), f64::from(b));
                *x += weight * a;
                *y += weight * b;
                *squares += weight * (a * a + b * b);
                *product += weight * (a * b);
            }
        }
        for (left, similarity) in similarities.iter_mut().enumerate() {
            let mut moments = WindowMoments::default();
            for (i, &weight) in weights.iter().enumerate() {
                moments.x += weight * x[left + i];
                moments.y += weight * y[left + i];
                moments.squares += weight * squares[left + i];
                moments.product += weight * product[left + i];
            }
            *similarity = moments.similarity();
        }
        if let Some(Centers { mask, first }) = centers {
            for (similarity, &code) in similarities.iter_mut().zip(&mask.row(top + first)[*first..]) {
                *similarity = if code > 0 { *similarity } else { 0.0 };
                count += usize::from(code > 0);
            }
        } else {
            count += columns;
        }
        sum += similarities.iter().sum::<f64>();
    }
    sum / count.max(1) as f64
}

/// Gaussian weights along one axis, of sum 1.
fn weights() -> [f64; WINDOW_PX] {
    let weights: [f64; WINDOW_PX] =
        std::array::from_fn(|i| (-0.5 * ((i as f64 - RADIUS_PX as f64) / SIGMA_PX).powi(2)).exp());
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// The unchanged plane if windows fit, else with half a window of reflection around it.
fn extended(plane: &Plane<u8>) -> Cow<'_, Plane<u8>> {
    let (width, height) = plane.size();
    if width.min(height) >= WINDOW_PX {
        return Cow::Borrowed(plane);
    }
    Cow::Owned(Plane::from_fn(
        width + 2 * RADIUS_PX,
        height + 2 * RADIUS_PX,
        |x, y| {
            let x = reflected(x as isize - RADIUS_PX as isize, width);
            let y = reflected(y as isize - RADIUS_PX as isize, height);
            plane.pixel(x, y)
        },
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fast(x: &Plane<u8>, y: &Plane<u8>) -> f64 {
        separable(&extended(x), &extended(y), None)
    }

    #[test]
    fn two_passes_agree_with_the_definition() {
        for (width, height) in [(1, 1), (1, 9), (10, 40), (11, 11), (12, 11), (31, 23), (64, 13)] {
            let x = Plane::from_fn(width, height, |x, y| (x * 37 + y * y * 11) as u8);
            let y = Plane::from_fn(width, height, |x, y| (x * x * 5 + y * 29) as u8);
            // Both sum the same terms; 121 products of 16-bit values in f64.
            assert!(
                (fast(&x, &y) - ssim_reference(&x, &y)).abs() < 1e-11,
                "{width}×{height}"
            );
        }
    }

    #[test]
    fn equal_pictures_are_at_one_and_inverse_ones_below_zero() {
        let x = Plane::from_fn(20, 20, |x, y| if (x + y) % 2 == 0 { 255 } else { 0 });
        assert!((fast(&x, &x) - 1.0).abs() < 1e-12);
        assert!(fast(&x, &x.map(|code| 255 - code)) < -0.9);
    }

    #[test]
    fn constants_are_compared_by_their_means_alone() {
        let (x, y) = (Plane::filled(15, 15, 100u8), Plane::filled(15, 15, 150u8));
        let expected = (2.0 * 15_000.0 + C1) / (10_000.0 + 22_500.0 + C1);
        assert!((fast(&x, &y) - expected).abs() < 1e-9);
    }

    #[test]
    fn small_pictures_are_reflected_about_their_edge_pixels() {
        let plane = Plane::new(3, 1, vec![1u8, 2, 3]).unwrap();
        let extended = extended(&plane);
        assert_eq!(extended.row(0), &[2, 1, 2, 3, 2, 1, 2, 3, 2, 1, 2, 3, 2]);
    }
}
