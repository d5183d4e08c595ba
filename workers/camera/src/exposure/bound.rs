//! Error bound of a metered gain and of the exposed light.
//!
//! With `y` clamped to `target/64..=64 target` the gain is `target/y`. The metered luminance is an order statistic: if
//! no pixel's luminance errs by more than e, neither does y. Therefore the gains of the fast variant and of the
//! reference differ by at most `e/y` of the smaller one, y the smaller of both luminances.

use spec::Metering;

use crate::rounding;

/// Roundings of an f32 luminance: the weight, its product, two sums, the fall-off, its product.
const LUMINANCE_ROUNDINGS: f64 = 6.0;

/// Relative rounding of an f32 luminance.
#[must_use]
pub fn luminance_rounding() -> f64 {
    rounding::relative(LUMINANCE_ROUNDINGS)
}

/// Gain of an error of the vignetted light in exposed light clipped at `exposed_peak`: `g (1 + peak/target)`. The gains
/// of the fast variant and of the reference are at most `gain`. The rounding of the luminance is not included.
#[must_use]
pub fn metered_slope(gain: f64, metering: &Metering, exposed_peak: f64) -> f64 {
    gain * (1.0 + exposed_peak / metering.target)
}

#[cfg(test)]
mod tests {
    use imaging::Rgb;
    use imaging::random::Stream;

    use super::super::{metered, metered_reference};
    use super::*;

    /// Luminances of pixels, error of each light, and metering of a case.
    struct Case {
        light: Rgb<f64>,
        erring: Rgb<f32>,
        error: f64,
        metering: Metering,
    }

    /// Pictures with many ties at the metered pixel, with few, and dark ones; all errors have one sign.
    fn case(number: u64) -> Case {
        let stream = Stream::stage(3, "metering");
        let unit = |element: u64| stream.unit(number, element);
        let level = libm::exp(-16.0 * unit(0));
        let error = level * libm::exp(-14.0 * unit(1));
        let metering = Metering {
            target: [0.01, 0.5, 4.0][(number % 3) as usize],
            percentile: [0.0, 0.5, 0.95, 1.0][(number % 4) as usize],
            lag_frames: 0.0,
        };
        let spread = [0.0, 1e-6, 1.0][(number / 4 % 3) as usize];
        let side = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
        let light = Rgb::from_fn(10, 10, |x, y| {
            [0, 1, 2].map(|channel| {
                let sample = (5 + channel + 3 * (x + 10 * y)) as u64;
                error + level * (1.0 - spread * unit(sample))
            })
        });
        // Within the error after rounding to f32, too.
        let erring = light.map(|&v| (v + side * error * 0.999) as f32);
        let planes = light.planes().iter().zip(erring.planes());
        let errors = planes.flat_map(|(light, erring)| light.data().iter().zip(erring.data()));
        let error = errors.map(|(v, e)| (v - f64::from(*e)).abs()).fold(0.0, f64::max);
        Case {
            light,
            erring,
            error,
            metering,
        }
    }

    #[test]
    fn exposed_light_errs_by_no_more_than_the_slope_of_its_factor() {
        let mut nearest = 0.0f64;
        for number in 0..3000 {
            let Case {
                light,
                erring,
                error,
                metering,
            } = case(number);
            let exact = metered_reference(&light, &metering);
            let fast = metered(&erring, None, &metering);
            for peak in [1.0, f64::INFINITY] {
                let planes = light.planes().iter().zip(erring.planes());
                for (light, erring) in planes.flat_map(|(l, e)| l.data().iter().zip(e.data())) {
                    let exposed = [light * exact, f64::from(*erring) * fast];
                    let peak = peak.min(exposed[0].max(exposed[1]));
                    let [a, b] = exposed.map(|v| v.min(peak));
                    let slope = metered_slope(exact.max(fast), &metering, peak);
                    let bound = slope * error + luminance_rounding() * peak + rounding::absolute(1.0, peak);
                    assert!((a - b).abs() <= bound, "{number}: {a} {b} {bound:e}");
                    nearest = nearest.max((a - b).abs() / bound);
                }
            }
        }
        assert!(nearest > 0.5, "{nearest}");
    }
}
