//! The mean over a square window that is clipped to the picture.

use imaging::Plane;
use imaging::simd::vectorised;

use super::sums::{WindowSums, inside, inverse_counts};
use crate::method::Variant;

/// The mean of the samples within `radius` columns and rows of each sample, divided by the number that lie inside.
#[must_use]
pub fn box_mean(plane: &Plane<f64>, radius: usize, variant: Variant) -> Plane<f64> {
    match variant {
        Variant::Fast => fast(plane, radius),
        Variant::Reference => reference(plane, radius),
    }
}

/// The sums of all windows, along rows first.
fn reference(plane: &Plane<f64>, radius: usize) -> Plane<f64> {
    let (width, height) = plane.size();
    let along = Plane::from_fn(width, height, |x, y| {
        inside(x, radius, width).map(|i| plane.at(i, y)).sum::<f64>()
    });
    Plane::from_fn(width, height, |x, y| {
        let rows = inside(y, radius, height);
        let count = rows.len() * inside(x, radius, width).len();
        rows.map(|j| along.at(x, j)).sum::<f64>() / count as f64
    })
}

fn fast(plane: &Plane<f64>, radius: usize) -> Plane<f64> {
    let (width, height) = plane.size();
    let (across, down) = (inverse_counts(width, radius), inverse_counts(height, radius));
    let none = vec![0.0; width];
    let mut sums = WindowSums::<1>::new(width, radius);
    let mut means = Plane::filled(width, height, 0.0);
    for y in 0..radius.min(height) {
        slide(&mut sums.columns[0], plane.row(y), &none);
    }
    for y in 0..height {
        let enters = if y + radius < height {
            plane.row(y + radius)
        } else {
            &none
        };
        let leaves = if y > radius {
            plane.row(y - radius - 1)
        } else {
            &none
        };
        slide(&mut sums.columns[0], enters, leaves);
        sums.total();
        divide(sums.windows(0), &across, down[y], means.row_mut(y));
    }
    means
}

fn slide(column: &mut [f64], enters: &[f64], leaves: &[f64]) {
    vectorised(
        #[inline(always)]
        || super::sums::exchange(column, enters, leaves),
    );
}

fn divide((before, end): (&[f64], &[f64]), across: &[f64], down: f64, means: &mut [f64]) {
    for ((mean, (before, end)), across) in means.iter_mut().zip(before.iter().zip(end)).zip(across) {
        *mean = (end - before) * (across * down);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_is_clipped_to_the_picture() {
        let plane = Plane::new(4, 1, vec![1.0, 2.0, 3.0, 6.0]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(box_mean(&plane, 1, variant).data(), &[1.5, 2.0, 11.0 / 3.0, 4.5]);
            assert_eq!(box_mean(&plane, 0, variant), plane);
            assert_eq!(box_mean(&plane, 9, variant).data(), &[3.0; 4]);
        }
    }
}
