//! Mean over a square window clipped to the picture, in f64.

use imaging::{Plane, vectorized};

use super::guided::box_mean;
use super::sums::{WindowSums, exchange, inverse_counts};
use crate::variant::Variant;

/// The means of K planes of one size over the samples within `radius` columns and rows.
#[must_use]
pub fn window_mean<const K: usize>(
    planes: [&Plane<f64>; K],
    radius: usize,
    variant: Variant,
) -> [Plane<f64>; K] {
    match variant {
        Variant::Fast => vectorized!(running(planes, radius)),
        Variant::Reference => planes.map(|plane| box_mean(plane, radius)),
    }
}

#[inline(always)]
fn running<const K: usize>(planes: [&Plane<f64>; K], radius: usize) -> [Plane<f64>; K] {
    let (width, height) = planes.first().map_or((0, 0), |plane| plane.size());
    let (across, down) = (inverse_counts(width, radius), inverse_counts(height, radius));
    let mut sums = WindowSums::<K>::new(width, radius);
    let mut means = planes.map(|plane| Plane::filled(width, plane.height(), 0.0));
    let no_row = vec![0.0; width];
    for (columns, plane) in sums.columns.iter_mut().zip(planes) {
        for y in 0..radius.min(height) {
            exchange(columns, plane.row(y), &no_row);
        }
    }
    for y in 0..height {
        for (columns, plane) in sums.columns.iter_mut().zip(planes) {
            let enters = if y + radius < height {
                plane.row(y + radius)
            } else {
                &no_row
            };
            let leaves = if y > radius {
                plane.row(y - radius - 1)
            } else {
                &no_row
            };
            exchange(columns, enters, leaves);
        }
        sums.total();
        for (quantity, mean) in means.iter_mut().enumerate() {
            let (before, after) = sums.windows(quantity);
            let windows = before.iter().zip(after).zip(&across);
            for (mean, ((before, after), across)) in mean.row_mut(y).iter_mut().zip(windows) {
                *mean = (after - before) * (across * down[y]);
            }
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_plane_has_its_means() {
        let plane = Plane::new(4, 1, vec![1.0, 2.0, 3.0, 6.0]).unwrap();
        let doubled = plane.map(|value| 2.0 * value);
        for variant in [Variant::Fast, Variant::Reference] {
            let [mean, twice] = window_mean([&plane, &doubled], 1, variant);
            assert_eq!(mean.data(), &[1.5, 2.0, 11.0 / 3.0, 4.5]);
            assert_eq!(twice.data(), &[3.0, 4.0, 22.0 / 3.0, 9.0]);
            assert_eq!(window_mean([&plane], 9, variant)[0].data(), &[3.0; 4]);
        }
    }
}
