//! Orientation by the intensity centroid (Rosin 1999; Rublee et al. 2011): the direction from a feature to the centroid
//! `(Σ x I, Σ y I)` of the codes in a disc of radius 15.

use imaging::Plane;

/// Radius of the disc.
pub(crate) const RADIUS: usize = 15;

/// Half the length of each row of the disc by its distance from the center: `floor(sqrt(R² - y²))`.
const HALF_LENGTHS: [usize; RADIUS + 1] = [15, 14, 14, 14, 14, 14, 13, 13, 12, 12, 11, 10, 9, 7, 5, 0];

/// A unit vector in picture axes, x to the right and y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Direction {
    pub(crate) x: f32,
    pub(crate) y: f32,
}

/// The direction to the centroid; to the right if the centroid is the center.
#[inline(always)]
pub(crate) fn find_direction(gray: &Plane<u8>, x: usize, y: usize) -> Direction {
    let (mut across, mut down) = (0i32, 0i32);
    for j in 0..=2 * RADIUS {
        let half = HALF_LENGTHS[j.abs_diff(RADIUS)];
        let row = &gray.row(y + j - RADIUS)[x - half..=x + half];
        let (mut sum, mut moment) = (0i32, 0i32);
        for (i, &code) in row.iter().enumerate() {
            sum += i32::from(code);
            moment += i as i32 * i32::from(code);
        }
        across += moment - half as i32 * sum;
        down += (j as i32 - RADIUS as i32) * sum;
    }
    let (across, down) = (f64::from(across), f64::from(down));
    let length = (across * across + down * down).sqrt();
    if length == 0.0 {
        return Direction { x: 1.0, y: 0.0 };
    }
    Direction {
        x: (across / length) as f32,
        y: (down / length) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_disc_has_integer_half_lengths() {
        for (y, half) in HALF_LENGTHS.into_iter().enumerate() {
            let square = RADIUS * RADIUS - y * y;
            assert!(half * half <= square && (half + 1) * (half + 1) > square, "{y}");
        }
    }

    #[test]
    fn the_direction_follows_a_ramp() {
        let slopes = [(4isize, 0isize), (0, 4), (-4, 0), (0, -4), (3, 4), (-4, 3)];
        for (u, v) in slopes {
            let ramp = Plane::from_fn(31, 31, |x, y| {
                (128 + u * (x as isize - 15) / 2 + v * (y as isize - 15) / 2) as u8
            });
            let length = ((u * u + v * v) as f32).sqrt();
            let direction = find_direction(&ramp, 15, 15);
            // Halved codes are rounded.
            assert!((direction.x - u as f32 / length).abs() < 0.02, "{direction:?}");
            assert!((direction.y - v as f32 / length).abs() < 0.02, "{direction:?}");
        }
        let flat = Plane::filled(31, 31, 80u8);
        assert_eq!(find_direction(&flat, 15, 15), Direction { x: 1.0, y: 0.0 });
    }
}
