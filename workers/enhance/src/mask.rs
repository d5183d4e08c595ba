//! The part of a picture that an enhancement keeps: a robot's camera may see the robot's housing.

use std::ops::Range;

use imaging::{Plane, Raster};
use spec::{Circle, Mask, MaskImage, Saturated};

use crate::blocks::window_max;
use crate::result::EnhanceError;
use crate::variant::Variant;

/// The kept part of a picture, 255 where it is kept and 0 elsewhere; `None` keeps all of it.
///
/// # Errors
/// [`EnhanceError::MaskSize`]: the mask is drawn for pictures of another size; [`EnhanceError::Mask`]: it cannot be decoded.
pub fn kept(picture: &Raster, mask: &Mask) -> Result<Option<Plane<u8>>, EnhanceError> {
    let (width, height) = (picture.width(), picture.height());
    Ok(match mask {
        Mask::None => None,
        Mask::Paper => Some(circle_plane(width, height, &Circle::PAPER)),
        Mask::Circle(circle) => Some(circle_plane(width, height, circle)),
        Mask::Saturated(saturated) => Some(unsaturated(picture, saturated)),
        Mask::Image(image) => Some(drawn_plane(image, (width, height))?),
    })
}

fn drawn_plane(image: &MaskImage, picture: (usize, usize)) -> Result<Plane<u8>, EnhanceError> {
    let plane = image.decode().map_err(EnhanceError::Mask)?;
    let mask = plane.size();
    match mask == picture {
        true => Ok(plane),
        false => Err(EnhanceError::MaskSize { picture, mask }),
    }
}

/// 255 inside the circle and 0 outside.
///
/// Center `(trunc(x W), trunc(y H))` and radius `trunc(r W)` in pixels; a pixel is inside if its squared distance is at
/// most the squared radius. With radius 0 only the center is inside; the circle may be outside the picture.
#[must_use]
pub fn circle_plane(width: usize, height: usize, circle: &Circle) -> Plane<u8> {
    let mut mask = Plane::filled(width, height, 0u8);
    for y in 0..height {
        mask.row_mut(y)[inside(circle, (width, height), y)].fill(255);
    }
    mask
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

/// 0 at pixels with a channel of at least the threshold and in squares around them, 255 elsewhere.
fn unsaturated(picture: &Raster, saturated: &Saturated) -> Plane<u8> {
    let colors = picture.to_rgb8();
    let bright = colors.pixels().map(|pixel| {
        let is_saturated = pixel.iter().any(|&code| code >= saturated.threshold);
        if is_saturated { 255 } else { 0 }
    });
    let bright = Plane::new(picture.width(), picture.height(), bright.collect());
    let bright = bright.expect("a value for each pixel");
    window_max(&bright, saturated.dilation_px, Variant::Fast).map(|&code: &u8| 255 - code)
}

/// Sets every channel of the pixels outside the mask to 0. `codes` holds `channels` codes for each pixel.
pub fn black_out(codes: &mut [u8], channels: usize, mask: &Plane<u8>) {
    for (pixel, &kept) in codes.chunks_exact_mut(channels).zip(mask.data()) {
        if kept == 0 {
            pixel.fill(0);
        }
    }
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    fn circle(center_x: f64, center_y: f64, radius: f64) -> Circle {
        Circle {
            center_x,
            center_y,
            radius,
        }
    }

    #[test]
    fn a_radius_of_two_keeps_thirteen_pixels() {
        let mask = circle_plane(5, 5, &circle(0.4, 0.4, 0.4));
        let kept: Vec<usize> = (0..5)
            .map(|y| mask.row(y).iter().filter(|&&m| m == 255).count())
            .collect();
        assert_eq!(kept, [1, 3, 5, 3, 1]);
    }

    #[test]
    fn radius_zero_keeps_the_center() {
        let mask = circle_plane(2, 2, &Circle::PAPER);
        assert_eq!(mask.data(), &[255, 0, 0, 0]);
    }

    #[test]
    fn a_circle_outside_the_picture_keeps_nothing() {
        let mask = circle_plane(8, 8, &circle(-100.0, 50.0, 1.0));
        assert!(mask.data().iter().all(|&m| m == 0));
    }

    #[test]
    fn saturated_pixels_and_their_surroundings_are_removed() {
        let picture = Rgb8::from_fn(7, 5, |x, y| if (x, y) == (3, 2) { [9, 9, 250] } else { [249; 3] });
        let mask = Mask::Saturated(Saturated {
            threshold: 250,
            dilation_px: 1,
        });
        let kept = kept(&picture.into(), &mask).unwrap().unwrap();
        let removed = Plane::from_fn(7, 5, |x, y| {
            if x.abs_diff(3) <= 1 && y.abs_diff(2) <= 1 {
                0
            } else {
                255
            }
        });
        assert_eq!(kept, removed);
    }

    #[test]
    fn black_out_clears_every_channel() {
        let mut codes = vec![9u8; 6];
        black_out(&mut codes, 3, &Plane::new(2, 1, vec![255, 0]).unwrap());
        assert_eq!(codes, [9, 9, 9, 0, 0, 0]);
    }
}
