//! The circular mask: a robot's camera sees its own housing outside it.

use imaging::Plane;

use super::options::Circle;

/// 255 inside the circle and 0 outside.
///
/// Centre `(trunc(x W), trunc(y H))` and radius `trunc(r W)` in pixels; a pixel is inside when its squared distance
/// is not above the squared radius. With radius 0 the centre alone is inside; the circle may lie outside the picture.
#[must_use]
pub fn plane(width: usize, height: usize, circle: &Circle) -> Plane<u8> {
    let centre_x = (circle.centre_x * width as f64).trunc() as i64;
    let centre_y = (circle.centre_y * height as f64).trunc() as i64;
    let radius = (circle.radius * width as f64).trunc() as i64;
    let mut mask = Plane::filled(width, height, 0u8);
    for y in 0..height {
        let dy = y as i64 - centre_y;
        let room = radius * radius - dy * dy;
        if room < 0 {
            continue;
        }
        let reach = room.isqrt();
        let first = (centre_x - reach).clamp(0, width as i64) as usize;
        let end = (centre_x + reach + 1).clamp(0, width as i64) as usize;
        mask.row_mut(y)[first..end].fill(255);
    }
    mask
}

/// Sets every channel of the pixels outside the mask to 0.
pub fn black_out(codes: &mut [u8], channels: usize, mask: &Plane<u8>) {
    if mask.data().is_empty() {
        return;
    }
    let rows = codes.chunks_exact_mut(channels * mask.width());
    for (codes, kept) in rows.zip(mask.data().chunks_exact(mask.width())) {
        // Run by run: a circle has at most two runs of black in a row.
        let mut start = 0;
        while let Some(black) = kept[start..].iter().position(|&kept| kept == 0) {
            let first = start + black;
            let run = kept[first..].iter().position(|&kept| kept != 0);
            start = run.map_or(kept.len(), |run| first + run);
            codes[channels * first..channels * start].fill(0);
        }
    }
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
                centre_x: 0.4,
                centre_y: 0.4,
                radius: 0.4,
            },
        );
        let kept: Vec<usize> = (0..5)
            .map(|y| mask.row(y).iter().filter(|&&m| m == 255).count())
            .collect();
        assert_eq!(kept, [1, 3, 5, 3, 1]);
    }

    #[test]
    fn radius_zero_keeps_the_centre() {
        let mask = plane(2, 2, &Circle::default());
        assert_eq!(mask.data(), &[255, 0, 0, 0]);
    }

    #[test]
    fn a_circle_outside_the_picture_keeps_nothing() {
        let mask = plane(
            8,
            8,
            &Circle {
                centre_x: -100.0,
                centre_y: 50.0,
                radius: 1.0,
            },
        );
        assert!(mask.data().iter().all(|&m| m == 0));
    }

    #[test]
    fn black_out_clears_every_channel() {
        let mut codes = vec![9u8; 6];
        black_out(&mut codes, 3, &Plane::new(2, 1, vec![255, 0]).unwrap());
        assert_eq!(codes, [9, 9, 9, 0, 0, 0]);
    }
}
