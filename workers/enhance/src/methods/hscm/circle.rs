//! The circular mask: outside it a robot's camera sees its housing.

use std::ops::Range;

use imaging::Plane;

/// The visible circle relative to the picture; it may be outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Center column relative to the width.
    pub center_x: f64,
    /// Center row relative to the height.
    pub center_y: f64,
    /// Radius relative to the width.
    pub radius: f64,
}

/// The circle of HSCM.
pub const HSCM: Circle = Circle {
    center_x: 0.45,
    center_y: 0.33,
    radius: 0.44,
};

/// 255 inside the circle and 0 outside.
///
/// Center `(trunc(x W), trunc(y H))` and radius `trunc(r W)` in pixels; a pixel is inside if its squared distance is at
/// most the squared radius. With radius 0 only the center is inside; the circle may be outside the picture.
#[must_use]
pub fn plane(width: usize, height: usize, circle: &Circle) -> Plane<u8> {
    let mut mask = Plane::filled(width, height, 0u8);
    for y in 0..height {
        mask.row_mut(y)[inside(circle, (width, height), y)].fill(255);
    }
    mask
}

/// Sets every channel of the pixels outside the circle to 0. `codes` holds `channels` codes for each pixel of a picture
/// of this size.
pub fn black_out(codes: &mut [u8], channels: usize, size: (usize, usize), circle: &Circle) {
    if size.0 == 0 {
        return;
    }
    for (y, row) in codes.chunks_exact_mut(channels * size.0).enumerate() {
        let kept = inside(circle, size, y);
        row[..channels * kept.start].fill(0);
        row[channels * kept.end..].fill(0);
    }
}

/// The columns of row `y` inside the circle.
fn inside(circle: &Circle, (width, height): (usize, usize), y: usize) -> Range<usize> {
    let center_x = (circle.center_x * width as f64).trunc() as i64;
    let center_y = (circle.center_y * height as f64).trunc() as i64;
    let radius = (circle.radius * width as f64).trunc() as i64;
    let dy = y as i64 - center_y;
    let room = radius * radius - dy * dy;
    if room < 0 {
        return 0..0;
    }
    let reach = room.isqrt();
    let [start, end] =
        [center_x - reach, center_x + reach + 1].map(|x: i64| x.clamp(0, width as i64) as usize);
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radius_of_two_keeps_thirteen_pixels() {
        let mask = plane(
            5,
            5,
            &Circle {
                center_x: 0.4,
                center_y: 0.4,
                radius: 0.4,
            },
        );
        let kept: Vec<usize> = (0..5)
            .map(|y| mask.row(y).iter().filter(|&&m| m == 255).count())
            .collect();
        assert_eq!(kept, [1, 3, 5, 3, 1]);
    }

    #[test]
    fn radius_zero_keeps_the_center() {
        let mask = plane(2, 2, &HSCM);
        assert_eq!(mask.data(), &[255, 0, 0, 0]);
    }

    #[test]
    fn a_circle_outside_the_picture_keeps_nothing() {
        let mask = plane(
            8,
            8,
            &Circle {
                center_x: -100.0,
                center_y: 50.0,
                radius: 1.0,
            },
        );
        assert!(mask.data().iter().all(|&m| m == 0));
    }

    #[test]
    fn black_out_clears_every_channel() {
        let mut codes = vec![9u8; 6];
        black_out(
            &mut codes,
            3,
            (2, 1),
            &Circle {
                center_x: 0.0,
                center_y: 0.0,
                radius: 0.0,
            },
        );
        assert_eq!(codes, [9, 9, 9, 0, 0, 0]);
    }
}
