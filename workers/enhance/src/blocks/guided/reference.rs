//! The definition, plane by plane in f64.

use imaging::Plane;

use super::guide::{Guide, solve};
use crate::blocks::sums::inside;

pub(super) fn guided(guide: &Guide, plane: &Plane<f64>) -> Plane<f64> {
    let (width, height) = plane.size();
    let mean = |plane: &Plane<f64>| box_mean(plane, guide.radius_px);
    let channels = guide.channels.each_ref();
    let colors = channels.map(|codes| codes.map(|&code| guide.scale * f64::from(code)));
    let means = colors.each_ref().map(mean);
    let plane_mean = mean(plane);

    let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    let spread = pairs.map(|(i, j)| {
        let product_mean = mean(&combine(&colors[i], &colors[j], |a, b| a * b));
        let mean_product = combine(&means[i], &means[j], |a, b| a * b);
        combine(&product_mean, &mean_product, |a, b| a - b)
    });
    let with_plane = [0, 1, 2].map(|i| {
        let product_mean = mean(&combine(&colors[i], plane, |a, b| a * b));
        let mean_product = combine(&means[i], &plane_mean, |a, b| a * b);
        combine(&product_mean, &mean_product, |a, b| a - b)
    });

    let slopes = Plane::from_fn(width, height, |x, y| {
        let mut matrix = spread.each_ref().map(|plane| plane.pixel(x, y));
        for diagonal in [0, 3, 5] {
            matrix[diagonal] += guide.regularization;
        }
        solve(matrix, with_plane.each_ref().map(|plane| plane.pixel(x, y)))
    });
    let offset = Plane::from_fn(width, height, |x, y| {
        let slope = slopes.pixel(x, y);
        plane_mean.pixel(x, y) - (0..3).map(|i| slope[i] * means[i].pixel(x, y)).sum::<f64>()
    });
    let slopes = [0, 1, 2].map(|i| mean(&slopes.map(|slope| slope[i])));
    let offset = mean(&offset);
    Plane::from_fn(width, height, |x, y| {
        (0..3)
            .map(|i| slopes[i].pixel(x, y) * colors[i].pixel(x, y))
            .sum::<f64>()
            + offset.pixel(x, y)
    })
}

/// The mean of the samples within `radius` columns and rows, over the part of the window inside the plane.
pub(in crate::blocks) fn box_mean(plane: &Plane<f64>, radius: usize) -> Plane<f64> {
    let (width, height) = plane.size();
    let along = Plane::from_fn(width, height, |x, y| {
        inside(x, radius, width).map(|i| plane.pixel(i, y)).sum::<f64>()
    });
    Plane::from_fn(width, height, |x, y| {
        let rows = inside(y, radius, height);
        let count = rows.len() * inside(x, radius, width).len();
        rows.map(|j| along.pixel(x, j)).sum::<f64>() / count as f64
    })
}

fn combine(a: &Plane<f64>, b: &Plane<f64>, join: fn(f64, f64) -> f64) -> Plane<f64> {
    Plane::from_fn(a.width(), a.height(), |x, y| join(a.pixel(x, y), b.pixel(x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_is_clipped_to_the_picture() {
        let plane = Plane::new(4, 1, vec![1.0, 2.0, 3.0, 6.0]).unwrap();
        assert_eq!(box_mean(&plane, 1).data(), &[1.5, 2.0, 11.0 / 3.0, 4.5]);
        assert_eq!(box_mean(&plane, 0), plane);
        assert_eq!(box_mean(&plane, 9).data(), &[3.0; 4]);
    }
}
