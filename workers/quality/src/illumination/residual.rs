//! The regression on the true illumination.

use imaging::{Plane, Rgb8};

use super::low_pass;
use crate::linear::{HALF_CODE, luminance};

/// Smallest standard deviation of the unexplained log illumination: with less, the light is even, or the reflectance
/// explains it.
const LEAST_SPREAD: f64 = 0.02;
/// Smallest coefficient of the input: with less, the picture does not show the illumination.
const LEAST_COEFFICIENT: f64 = 0.05;
/// Darker illumination, relative to the brightest, counts as this.
const LEAST_LIGHT: f32 = 1e-4;

/// The simulated light of a frame, in planes of the size of its picture.
#[derive(Debug, Clone, Copy)]
pub struct TrueLight<'a> {
    /// Luminance of the light from a white surface: lamps and daylight times transmittance, linear, of any scale.
    pub illumination: &'a Plane<f32>,
    /// Luminance of the picture in air under even light, linear, white = 1.
    pub reflectance: &'a Plane<f32>,
    /// The picture before enhancement.
    pub input: &'a Rgb8,
    /// Pixels of value 0 do not count.
    pub mask: Option<&'a Plane<u8>>,
}

/// The illumination of a frame, prepared for any number of enhanced pictures.
#[derive(Debug, Clone)]
pub struct Illumination {
    /// The part of the log illumination that 1 and the log reflectance do not explain; 0 where a pixel does not count.
    unexplained: Plane<f32>,
    /// `Σ l y` of the input. `None` if the residual is not defined.
    input: Option<f64>,
}

impl Illumination {
    /// Prepares a frame. A pixel counts if both planes are finite there and the mask is not 0. Values of `illumination`
    /// below 1e-4 of its maximum count as that, those of `reflectance` below half the light of code 1 as that.
    ///
    /// # Panics
    /// If the planes, picture and mask differ in size.
    #[must_use]
    pub fn new(light: &TrueLight) -> Self {
        let size = light.illumination.size();
        let input_size = (light.input.width(), light.input.height());
        assert!(
            size == light.reflectance.size()
                && size == input_size
                && light.mask.is_none_or(|mask| mask.size() == size),
            "planes, picture and mask have one size"
        );
        let finite = light.illumination.data().iter().filter(|value| value.is_finite());
        let floor = LEAST_LIGHT * finite.fold(0.0f32, |most, &value| most.max(value));
        let logs = light.illumination.map(|&value| match value {
            value if value.is_finite() && floor > 0.0 => libm::log(f64::from(value.max(floor))) as f32,
            _ => f32::NAN,
        });
        let mut unexplained = low_pass::smooth(&logs);
        let reflectance = light.reflectance.map(|&value| match value {
            value if value.is_finite() => libm::log(f64::from(value).max(HALF_CODE)) as f32,
            _ => f32::NAN,
        });
        let masked = light.mask.map(Plane::data);
        for (index, value) in unexplained.data_mut().iter_mut().enumerate() {
            let is_counted = masked.is_none_or(|mask| mask[index] > 0)
                && logs.data()[index].is_finite()
                && reflectance.data()[index].is_finite();
            if !is_counted {
                *value = f32::NAN;
            }
        }
        let spread = remove_explained(&mut unexplained, &reflectance);
        let mut illumination = Self {
            unexplained,
            input: None,
        };
        let product = illumination.product(light.input);
        let count_square = spread.count * spread.deviation * spread.deviation;
        let is_defined = spread.deviation >= LEAST_SPREAD && product >= LEAST_COEFFICIENT * count_square;
        illumination.input = is_defined.then_some(product);
        illumination
    }

    /// Columns and rows of the frame.
    pub(crate) fn size(&self) -> (usize, usize) {
        self.unexplained.size()
    }

    /// `β / β_input` of a picture of the frame. `None` if the light is even, if the reflectance explains it, or if the
    /// input does not depend on it: if the spread of l is below 0.02, or β_input below 0.05.
    ///
    /// # Panics
    /// If the picture has another size than the frame.
    #[must_use]
    pub fn residual(&self, picture: &Rgb8) -> Option<f64> {
        self.input.map(|input| self.product(picture) / input)
    }

    /// `Σ l y`.
    fn product(&self, picture: &Rgb8) -> f64 {
        let size = (picture.width(), picture.height());
        assert_eq!(size, self.unexplained.size(), "the picture is of the frame");
        let pixels = picture.pixels().zip(self.unexplained.data());
        let counted = pixels.filter(|(_, light)| **light != 0.0);
        counted
            .map(|(pixel, light)| f64::from(*light) * libm::log(luminance(pixel).max(HALF_CODE)))
            .sum()
    }
}

/// Number of counted pixels and standard deviation of the unexplained part.
struct Spread {
    count: f64,
    deviation: f64,
}

/// Subtracts the regression of the values on 1 and `others`; unknown values become 0.
fn remove_explained(values: &mut Plane<f32>, others: &Plane<f32>) -> Spread {
    let known = values
        .data()
        .iter()
        .zip(others.data())
        .filter(|(value, _)| !value.is_nan());
    let known = known.map(|(&value, &other)| (f64::from(value), f64::from(other)));
    let (mut count, mut value_sum, mut other_sum) = (0.0, 0.0, 0.0);
    for (value, other) in known.clone() {
        count += 1.0;
        value_sum += value;
        other_sum += other;
    }
    let divisor = f64::max(count, 1.0);
    let (value_mean, other_mean) = (value_sum / divisor, other_sum / divisor);
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (value, other) in known {
        covariance += (value - value_mean) * (other - other_mean);
        variance += (other - other_mean) * (other - other_mean);
    }
    let slope = if variance > 0.0 {
        covariance / variance
    } else {
        0.0
    };
    let mut squares = 0.0;
    for (value, &other) in values.data_mut().iter_mut().zip(others.data()) {
        let rest = f64::from(*value) - value_mean - slope * (f64::from(other) - other_mean);
        *value = if rest.is_nan() { 0.0 } else { rest as f32 };
        squares += f64::from(*value) * f64::from(*value);
    }
    Spread {
        count,
        deviation: (squares / divisor).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use imaging::transfer;

    use super::*;

    const WIDTH: usize = 160;
    const HEIGHT: usize = 120;
    /// 8-bit codes, and the shadows of texture in the low-pass.
    const TOLERANCE: f64 = 0.03;

    fn lamp(x: usize, y: usize) -> f32 {
        let (u, v) = (x as f32 / 160.0 - 0.4, y as f32 / 160.0 - 0.3);
        0.15 + 0.8 / (1.0 + (u * u + v * v) / 0.08)
    }

    fn stone(x: usize, y: usize) -> f32 {
        let hash = (x as u32 / 5).wrapping_mul(0x9e37_79b1) ^ (y as u32 / 5).wrapping_mul(0x85eb_ca77);
        0.3 + 0.5 * ((hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d) >> 24) as f32 / 255.0
    }

    /// The floor under the lamp's light to a power.
    fn picture(power: f32) -> Rgb8 {
        Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
            let light = 0.8 * stone(x, y) * lamp(x, y).powf(power);
            [(255.0 * transfer::encode(f64::from(light)) + 0.5) as u8; 3]
        })
    }

    fn prepare(input: &Rgb8, mask: Option<&Plane<u8>>) -> Illumination {
        Illumination::new(&TrueLight {
            illumination: &Plane::from_fn(WIDTH, HEIGHT, |x, y| 37.0 * lamp(x, y)),
            reflectance: &Plane::from_fn(WIDTH, HEIGHT, stone),
            input,
            mask,
        })
    }

    #[test]
    fn the_residual_is_the_power_of_the_light_that_is_left() {
        let illumination = prepare(&picture(1.0), None);
        assert_eq!(illumination.residual(&picture(1.0)), Some(1.0));
        for power in [0.0, 0.25, 0.5, -0.3] {
            let residual = illumination.residual(&picture(power)).unwrap();
            assert!(
                (residual - f64::from(power)).abs() < TOLERANCE,
                "{residual} for {power}"
            );
        }
    }

    #[test]
    fn a_gain_does_not_matter_and_a_constant_or_black_picture_has_no_light_left() {
        let illumination = prepare(&picture(1.0), None);
        let darker = Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
            let light = 0.4 * stone(x, y) * lamp(x, y);
            [(255.0 * transfer::encode(f64::from(light)) + 0.5) as u8; 3]
        });
        assert!((illumination.residual(&darker).unwrap() - 1.0).abs() < TOLERANCE);
        for code in [0, 90, 255] {
            let constant = Rgb8::from_fn(WIDTH, HEIGHT, |_, _| [code; 3]);
            assert!(illumination.residual(&constant).unwrap().abs() < 1e-6);
        }
    }

    /// The coefficient of the light from the normal equations of all three regressors.
    fn coefficient_by_definition(picture: &Rgb8) -> f64 {
        let light = low_pass::smooth(&Plane::from_fn(WIDTH, HEIGHT, |x, y| lamp(x, y).ln()));
        let mut rows = [[0.0; 4]; 3];
        for (i, pixel) in picture.pixels().enumerate() {
            let regressors = [
                1.0,
                f64::from(stone(i % WIDTH, i / WIDTH)).ln(),
                f64::from(light.data()[i]),
            ];
            for (row, a) in rows.iter_mut().zip(regressors) {
                for (sum, b) in row.iter_mut().zip(regressors) {
                    *sum += a * b;
                }
                row[3] += a * luminance(pixel).max(HALF_CODE).ln();
            }
        }
        for i in 0..3 {
            for j in i + 1..3 {
                let factor = rows[j][i] / rows[i][i];
                for k in 0..4 {
                    rows[j][k] -= factor * rows[i][k];
                }
            }
        }
        rows[2][3] / rows[2][2]
    }

    #[test]
    fn the_residual_agrees_with_the_regression() {
        let illumination = prepare(&picture(1.0), None);
        let expected = coefficient_by_definition(&picture(0.4)) / coefficient_by_definition(&picture(1.0));
        let residual = illumination.residual(&picture(0.4)).unwrap();
        // Planes are kept in f32.
        assert!((residual - expected).abs() < 1e-5, "{residual} {expected}");
    }

    #[test]
    fn masked_and_unknown_pixels_do_not_count() {
        let mask = Plane::from_fn(WIDTH, HEIGHT, |x, _| if x < 100 { 255 } else { 0 });
        let illumination = prepare(&picture(1.0), Some(&mask));
        let half = picture(0.5);
        let spoiled = Rgb8::from_fn(
            WIDTH,
            HEIGHT,
            |x, y| if x < 100 { half.pixel(x, y) } else { [0; 3] },
        );
        assert_eq!(illumination.residual(&half), illumination.residual(&spoiled));
        let gap = Illumination::new(&TrueLight {
            illumination: &Plane::from_fn(WIDTH, HEIGHT, |x, y| if x < 100 { lamp(x, y) } else { f32::NAN }),
            reflectance: &Plane::from_fn(
                WIDTH,
                HEIGHT,
                |x, y| if y > 9 { stone(x, y) } else { f32::INFINITY },
            ),
            input: &picture(1.0),
            mask: None,
        });
        assert!((gap.residual(&half).unwrap() - 0.5).abs() < TOLERANCE);
    }

    #[test]
    fn without_contrast_of_the_light_there_is_no_residual() {
        let flat = |value: f32| Plane::filled(WIDTH, HEIGHT, value);
        let stones = Plane::from_fn(WIDTH, HEIGHT, stone);
        let lit = Plane::from_fn(WIDTH, HEIGHT, lamp);
        let black = Rgb8::from_fn(WIDTH, HEIGHT, |_, _| [0; 3]);
        let (seen, nothing) = (picture(1.0), Plane::filled(WIDTH, HEIGHT, 0u8));
        let cases = [
            (&flat(3.0), &stones, &seen, None),
            (&flat(0.0), &stones, &seen, None),
            (&flat(f32::NAN), &stones, &seen, None),
            (&lit, &lit, &seen, None),
            (&lit, &stones, &black, None),
            (&lit, &stones, &seen, Some(&nothing)),
        ];
        for (i, (illumination, reflectance, input, mask)) in cases.into_iter().enumerate() {
            let prepared = Illumination::new(&TrueLight {
                illumination,
                reflectance,
                input,
                mask,
            });
            assert_eq!(prepared.residual(&seen), None, "case {i}");
        }
    }

    #[test]
    fn a_picture_of_one_pixel_has_no_residual() {
        let pixel = Rgb8::from_fn(1, 1, |_, _| [90; 3]);
        let plane = Plane::filled(1, 1, 0.5f32);
        let prepared = Illumination::new(&TrueLight {
            illumination: &plane,
            reflectance: &plane,
            input: &pixel,
            mask: None,
        });
        assert_eq!(prepared.residual(&pixel), None);
    }
}
