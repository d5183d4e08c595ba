//! Error bound of a metered factor, and of the light that it exposes.
//!
//! With `y` cut to `target/64..=64 target` the factor is `target/y`. The metered luminance is an order statistic: if no pixel's
//! luminance errs by more than e, neither does y. So the factors of the fast form and of the reference differ by at most
//! `e/y` of either, y the smaller of both luminances.

use spec::Metering;

use super::{MOST_GAIN, share};
use crate::rounding;

/// Roundings of a luminance in f32: the weight, its product, two sums, the fall-off, its product.
const LUMINANCE_ROUNDINGS: f64 = 6.0;
/// Relative error of a factor in f64, that of powers included.
const IN_F64: f64 = 16.0 * f64::EPSILON;

/// Relative rounding of a metered luminance in f32.
#[must_use]
pub fn luminance_rounding() -> f64 {
    rounding::relative(LUMINANCE_ROUNDINGS)
}

/// How an error of the light behind the fall-off appears in light of at most `exposed_peak` that a metered factor of at most
/// `gain` exposes, to first order: `g (1 + peak/target)`.
#[must_use]
pub fn metered_slope(gain: f64, metering: &Metering, exposed_peak: f64) -> f64 {
    gain * (1.0 + exposed_peak / metering.target)
}

/// Limits of the metered luminance, white 1, known before a picture is metered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Luminance {
    /// Lower limit; 0 if unknown.
    pub least: f64,
    /// Upper limit; infinity if unknown.
    pub most: f64,
}

/// Limits of the factor of an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainLimits {
    /// The factor is at most this, in f32 and in f64.
    pub most: f64,
    /// Factors in f32 and in f64 differ by at most this share of the smaller one.
    pub relative_error: f64,
}

impl GainLimits {
    /// Limits of a fixed factor, the same in f32 and in f64.
    #[must_use]
    pub fn fixed(gain: f64) -> Self {
        Self {
            most: gain,
            relative_error: 0.0,
        }
    }

    /// Limits of a metered factor. `error` is the largest error of light behind the fall-off; no light may be below `-error`.
    #[must_use]
    pub fn metered(metering: &Metering, luminance: Luminance, error: f64) -> Self {
        let (darkest, brightest) = (metering.target / MOST_GAIN, metering.target * MOST_GAIN);
        let relative = rounding::relative(LUMINANCE_ROUNDINGS);
        let error = error * (1.0 + 3.0 * relative) + rounding::absolute(LUMINANCE_ROUNDINGS, 0.0);
        let (least, most) = (luminance.least - error, luminance.most + error);
        let cut = least.clamp(darkest, brightest);
        let is_fixed = most * (1.0 + relative) <= darkest || least * (1.0 - relative) >= brightest;
        Self {
            most: (metering.target / cut * (1.0 + relative)).min(MOST_GAIN),
            relative_error: if is_fixed {
                0.0
            } else {
                (1.0 + error / cut) * (1.0 + relative + IN_F64) - 1.0
            },
        }
    }

    /// Limits of the factor that [`super::lagging`] returns for factors within these limits and those before.
    ///
    /// Relative errors combine by the weights of the powers: `(1 + a)^(1-s) (1 + b)^s <= 1 + (1-s) a + s b`.
    #[must_use]
    pub fn lagging(&self, before: &Self, lag_frames: f64) -> Self {
        if lag_frames <= 0.0 {
            return *self;
        }
        let share = share(lag_frames);
        let most = libm::pow(before.most, 1.0 - share) * libm::pow(self.most, share);
        let relative = (1.0 - share) * before.relative_error + share * self.relative_error;
        Self {
            most: most * (1.0 + IN_F64),
            relative_error: relative + IN_F64,
        }
    }

    /// Largest error of exposed light, without the rounding of [`crate::vignette::expose`]. `error` is that of the light behind
    /// the fall-off, `exposed_peak` the brightest exposed light that counts: where it is cut at white, at most white.
    #[must_use]
    pub fn exposed_error(&self, error: f64, exposed_peak: f64) -> f64 {
        self.most * error + self.relative_error * exposed_peak
    }
}

#[cfg(test)]
mod tests {
    use imaging::Rgb;
    use imaging::random::Stream;

    use super::super::{lagging, metered, metered_reference};
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

    fn known(metering: &Metering, gain: f64) -> Luminance {
        Luminance {
            least: if gain < MOST_GAIN {
                metering.target / gain
            } else {
                0.0
            },
            most: if gain > 1.0 / MOST_GAIN {
                metering.target / gain
            } else {
                f64::INFINITY
            },
        }
    }

    #[test]
    fn factors_and_exposed_light_are_within_their_limits() {
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
            let least_known = Luminance {
                least: 0.0,
                most: f64::INFINITY,
            };
            for luminance in [known(&metering, exact), least_known] {
                let limits = GainLimits::metered(&metering, luminance, error);
                assert!(exact.max(fast) <= limits.most * (1.0 + 1e-15), "{number}");
                let apart = (exact - fast).abs() / exact.min(fast);
                assert!(
                    apart <= limits.relative_error,
                    "{number}: {apart:e} of {limits:?}"
                );
                for peak in [1.0, f64::INFINITY] {
                    let planes = light.planes().iter().zip(erring.planes());
                    for (light, erring) in planes.flat_map(|(l, e)| l.data().iter().zip(e.data())) {
                        let exposed = [light * exact, f64::from(*erring) * fast];
                        let peak = peak.min(exposed[0].max(exposed[1]));
                        let [a, b] = exposed.map(|v| v.min(peak));
                        let bound = limits.exposed_error(error, peak);
                        assert!((a - b).abs() <= bound, "{number}: {a} {b} {bound:e}");
                        nearest = nearest.max((a - b).abs() / bound);
                        let linear = metered_slope(limits.most, &metering, peak) * error;
                        // Beyond first order: rounding of luminances, and of the error that they carry.
                        let rest = rounding::absolute(40.0, peak);
                        let is_small = limits.relative_error <= 1.0;
                        assert!(!is_small || bound <= linear + rest, "{number}");
                    }
                }
            }
        }
        assert!(nearest > 0.5, "{nearest}");
    }

    #[test]
    fn a_cut_factor_has_no_error() {
        let metering = Metering {
            target: 0.5,
            percentile: 0.5,
            lag_frames: 0.0,
        };
        let dark = Luminance {
            least: 0.0,
            most: 0.5 / 64.0 - 2e-4,
        };
        assert_eq!(
            GainLimits::metered(&metering, dark, 1e-4),
            GainLimits::fixed(64.0)
        );
        let bright = Luminance {
            least: 33.0,
            most: f64::INFINITY,
        };
        assert_eq!(GainLimits::metered(&metering, bright, 1e-4).relative_error, 0.0);
    }

    #[test]
    fn a_sequence_errs_by_no_more_than_its_limits() {
        let stream = Stream::stage(4, "lag");
        for number in 0..200 {
            let unit = |element: u64| stream.unit(number, element);
            let lag_frames = 30.0 * unit(0) * unit(1);
            let factor = |frame: u64| libm::exp(8.0 * unit(2 + frame) - 4.0);
            let limits = |frame: u64| GainLimits {
                most: factor(frame) * 1.1,
                relative_error: 0.1 * unit(100 + frame),
            };
            let (mut exact, mut fast, mut known) = (factor(0), factor(0), limits(0));
            fast *= 1.0 + known.relative_error;
            for frame in 1..20 {
                let next = limits(frame);
                exact = lagging(exact, factor(frame), lag_frames);
                fast = lagging(fast, factor(frame) * (1.0 + next.relative_error), lag_frames);
                known = next.lagging(&known, lag_frames);
                assert!(fast <= known.most && exact <= known.most, "{number}");
                let apart = (fast - exact) / exact;
                assert!(apart <= known.relative_error, "{number}: {apart:e} of {known:?}");
            }
        }
    }
}
