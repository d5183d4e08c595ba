//! Snow in f64: every particle on every pixel.

use imaging::{Plane, Rgb};

use super::world::Surround;
use super::{Flake, LitFlake, lit};
use crate::range::is_hole;

/// Lays the particles, given the farthest first, over a picture in linear light; returns the picture and the opacity that they
/// have together in green. `I ← I (1 − α) + albedo L α` with `α = opacity e^{−c R} s`, s the share that its [`Spot`](super::Spot)
/// has at the pixel.
#[must_use]
pub fn snow_reference(
    image: &Rgb<f64>,
    flakes: &[Flake],
    albedo: [f64; 3],
    surround: &Surround<'_>,
) -> (Rgb<f64>, Plane<f64>) {
    let lit = lit(flakes, albedo, surround);
    let pixel = |x: usize, y: usize| {
        let behind = f64::from(surround.range.pixel(x, y));
        let (mut light, mut clear) = (image.pixel(x, y), 1.0);
        for LitFlake {
            flake,
            opacity,
            color,
        } in &lit
        {
            if !is_hole(behind) && behind <= flake.range_m {
                continue;
            }
            let (dx, dy) = (x as f64 - flake.center[0], y as f64 - flake.center[1]);
            let disc = flake.spot.at(dx, dy);
            for i in 0..3 {
                light[i] += (color[i] - light[i]) * opacity[i] * disc;
            }
            clear *= 1.0 - opacity[1] * disc;
        }
        (light, 1.0 - clear)
    };
    let (width, height) = image.size();
    (
        Rgb::from_fn(width, height, |x, y| pixel(x, y).0),
        Plane::from_fn(width, height, |x, y| pixel(x, y).1),
    )
}
