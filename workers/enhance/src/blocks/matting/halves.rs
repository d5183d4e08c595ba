//! Halves and doubles the size of pictures and planes.

use imaging::Plane;

/// Means of 2 × 2 values; an odd last column or row counts twice.
pub(super) fn halved<T: Copy>(plane: &Plane<T>, mean: impl Fn([T; 4]) -> T) -> Plane<T> {
    let (width, height) = plane.size();
    Plane::from_fn(width.div_ceil(2), height.div_ceil(2), |x, y| {
        let (right, below) = ((2 * x + 1).min(width - 1), (2 * y + 1).min(height - 1));
        let (upper, lower) = (plane.row(2 * y), plane.row(below));
        mean([upper[2 * x], upper[right], lower[2 * x], lower[right]])
    })
}

pub(super) fn mean_code(codes: [u8; 4]) -> u8 {
    ((codes.into_iter().map(u32::from).sum::<u32>() + 2) / 4) as u8
}

pub(super) fn mean_value(values: [f64; 4]) -> f64 {
    values.into_iter().sum::<f64>() / 4.0
}

/// Bilinear interpolation of a [`halved`] plane to its original size.
pub(super) fn doubled(plane: &Plane<f64>, (width, height): (usize, usize)) -> Plane<f64> {
    let mut doubled = Plane::filled(width, height, 0.0);
    let mut between = vec![0.0; plane.width()];
    for y in 0..height {
        let (near, far) = sources(y, plane.height());
        for (value, (near, far)) in between.iter_mut().zip(plane.row(near).iter().zip(plane.row(far))) {
            *value = 0.75 * near + 0.25 * far;
        }
        for (x, value) in doubled.row_mut(y).iter_mut().enumerate() {
            let (near, far) = sources(x, between.len());
            *value = 0.75 * between[near] + 0.25 * between[far];
        }
    }
    doubled
}

/// The two half-size positions on both sides of a position, the containing one first.
fn sources(place: usize, count: usize) -> (usize, usize) {
    let near = place / 2;
    let far = if place.is_multiple_of(2) {
        near.saturating_sub(1)
    } else {
        (near + 1).min(count - 1)
    };
    (near, far)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_comes_back_inside() {
        let ramp = Plane::from_fn(9, 7, |x, y| 2.0 * x as f64 + y as f64);
        let half = halved(&ramp, mean_value);
        assert_eq!((half.size(), half.pixel(1, 1)), ((5, 4), 7.5));
        let back = doubled(&half, ramp.size());
        for (x, y) in [(1, 1), (2, 3), (6, 4)] {
            assert_eq!(back.pixel(x, y), ramp.pixel(x, y));
        }
        // The last column and row are half a step away.
        assert_eq!(half.pixel(4, 3), 22.0);
        assert_eq!(mean_code([1, 2, 2, 1]), 2);
    }
}
