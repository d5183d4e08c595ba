//! Demosaicing: from a sensor's codes to light in three channels.
//!
//! Behind color filters each pixel lacks two colors. They are the means of the nearest pixels of that color, with the
//! weights `[1 2 1; 2 4 2; 1 2 1]`, borders reflected without repeating the edge. Measured codes are kept. Sums of
//! codes are integers, so rounding is limited to the final product.

use imaging::{Plane, Rgb, cancel, reflected};
use spec::Cfa;

use crate::sensor::{Raw, SensorModel, color_of};

/// Light of every pixel, white = 1; noise can make it negative.
///
/// # Panics
/// For a mosaic of less than two columns or rows.
#[must_use]
pub fn light_of(raw: &Raw, sensor: &SensorModel) -> Rgb<f32> {
    let scale = sensor.light_per_dn();
    let black = f64::from(sensor.black_dn);
    let light = |quarters: u32| ((f64::from(quarters) * 0.25 - black) * scale) as f32;
    match raw {
        Raw::Planes(planes) => {
            let planes = planes.each_ref();
            let planes = planes.map(|plane| plane.map(|&code| light(4 * u32::from(code))));
            Rgb::new(planes).expect("three planes of one sensor")
        }
        Raw::Mosaic(codes) => demosaic(codes, sensor.cfa, light),
    }
}

/// Reference in f64, by the weights.
///
/// # Panics
/// As [`light_of`].
#[must_use]
pub fn light_of_reference(raw: &Raw, sensor: &SensorModel) -> Rgb<f64> {
    let light = |code: f64| (code - f64::from(sensor.black_dn)) * sensor.light_per_dn();
    let codes = match raw {
        Raw::Planes(planes) => {
            let planes = planes.each_ref();
            let planes = planes.map(|plane| plane.map(|&code| light(f64::from(code))));
            return Rgb::new(planes).expect("three planes of one sensor");
        }
        Raw::Mosaic(codes) => codes,
    };
    let (width, height) = codes.size();
    assert!(width > 1 && height > 1, "a mosaic has at least 2×2 pixels");
    Rgb::from_fn(width, height, |x, y| {
        [0, 1, 2].map(|channel| {
            if color_of(sensor.cfa, x, y) == Some(channel) {
                return light(f64::from(codes.pixel(x, y)));
            }
            let (mut sum, mut weights) = (0.0, 0.0);
            for (dy, dx) in (-1..=1).flat_map(|dy: isize| (-1..=1).map(move |dx: isize| (dy, dx))) {
                let (x, y) = (
                    reflected(x as isize + dx, width),
                    reflected(y as isize + dy, height),
                );
                if color_of(sensor.cfa, x, y) == Some(channel) {
                    let weight = f64::from((2 - dx.abs() as i32) * (2 - dy.abs() as i32));
                    sum += weight * light(f64::from(codes.pixel(x, y)));
                    weights += weight;
                }
            }
            sum / weights
        })
    })
}

/// The three colors of a pixel: four times its code, the sum of the codes left, right, above and below, twice the sum
/// of two of them, or the sum of the corners.
fn demosaic(codes: &Plane<u16>, cfa: Cfa, light: impl Fn(u32) -> f32) -> Rgb<f32> {
    let (width, height) = codes.size();
    assert!(width > 1 && height > 1, "a mosaic has at least 2×2 pixels");
    let mut planes: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; width * height]);
    for y in 0..height {
        cancel::check();
        let above = codes.row(reflected(y as isize - 1, height));
        let own = codes.row(y);
        let below = codes.row(reflected(y as isize + 1, height));
        let [first, second] = [0, 1].map(|x| color_of(cfa, x, y).unwrap_or_default());
        // The color missing from this row is above and below its greens, and at the corners of its others.
        let inside = if first == 1 { second } else { first };
        let [r, g, b] = &mut planes;
        let rows = [r, g, b].map(|plane| &mut plane[y * width..(y + 1) * width]);
        let [red, green, blue] = rows;
        let (inside_row, outside_row) = if inside == 0 { (red, blue) } else { (blue, red) };
        for x in 0..width {
            let left = reflected(x as isize - 1, width);
            let right = reflected(x as isize + 1, width);
            let horizontal = u32::from(own[left]) + u32::from(own[right]);
            let vertical = u32::from(above[x]) + u32::from(below[x]);
            let code = 4 * u32::from(own[x]);
            let is_green = (if x % 2 == 0 { first } else { second }) == 1;
            if is_green {
                green[x] = light(code);
                inside_row[x] = light(2 * horizontal);
                outside_row[x] = light(2 * vertical);
            } else {
                inside_row[x] = light(code);
                green[x] = light(horizontal + vertical);
                let corners = [above[left], above[right], below[left], below[right]];
                outside_row[x] = light(corners.map(u32::from).iter().sum());
            }
        }
    }
    let planes = planes.map(|data| Plane::new(width, height, data).expect("three colors of each pixel"));
    Rgb::new(planes).expect("three planes of one mosaic")
}
