//! Which implementation the fast variant uses: chosen from the size and the options alone.

use rustfft::FftPlannerScalar;
use rustfft::num_complex::Complex;

use super::padding::padded_side;
use crate::hscm::options::{Options, Profile, Settings};

/// Weight of the circular Gaussian that may be cut off, in parts of the whole. With logarithms in -4.6..=0 and
/// `r_high` 2.5 the filtered logarithm then moves by at most 1e-5: one code in several hundred is near enough to a
/// tie to change.
pub const KERNEL_TAIL: f64 = 1e-6;
/// Largest `r_high` of the single-precision passes. Rounding grows with `r_high · |ln eps|`: at this and
/// [`EPS_MIN_SINGLE`] it reaches a few 1e-4, well inside the 2e-3 that the filtered logarithm may be off.
pub const R_HIGH_MAX_SINGLE: f64 = 16.0;
/// Smallest `eps` of the single-precision passes, see [`R_HIGH_MAX_SINGLE`].
pub const EPS_MIN_SINGLE: f64 = 1e-6;
/// Largest sum of both kernel radii. Beyond it the transform costs less than the two passes.
pub const RADII_MAX: usize = 300;

/// How the filter is computed. A plain value: planning can be tested without filtering.
#[derive(Debug, Clone, PartialEq)]
pub enum Recipe {
    /// All logarithms are one value: they are scaled by `r_low`.
    Flat,
    /// Two passes with these half kernels, centre first.
    Separable {
        /// Weights along a row.
        kernel_x: Vec<f32>,
        /// Weights along a column.
        kernel_y: Vec<f32>,
    },
    /// The two-dimensional transform in double precision.
    Transform,
}

impl Recipe {
    /// The cheapest way to filter a picture of (width, height), at least 1×1, that is not flat.
    #[must_use]
    pub fn choose((width, height): (usize, usize), options: &Options) -> Self {
        let Settings {
            r_high, eps, profile, ..
        } = *options.settings();
        if r_high > R_HIGH_MAX_SINGLE || (profile == Profile::Standard && eps < EPS_MIN_SINGLE) {
            return Self::Transform;
        }
        let delta = options.delta_bins(width);
        match (
            half_kernel(padded_side(width), delta),
            half_kernel(padded_side(height), delta),
        ) {
            (Some(kernel_x), Some(kernel_y)) if kernel_x.len() + kernel_y.len() - 2 <= RADII_MAX => {
                Self::Separable { kernel_x, kernel_y }
            }
            _ => Self::Transform,
        }
    }
}

/// The circular convolution kernel whose transform over `n` bins is `exp(-k² / (2 delta²))`, from its centre outward
/// until less than [`KERNEL_TAIL`] remains; `None` when more than half the side would be needed.
fn half_kernel(n: usize, delta: f64) -> Option<Vec<f32>> {
    let mut bins: Vec<Complex<f64>> = (0..n)
        .map(|k| {
            let signed = k.min(n - k) as f64 / delta;
            Complex::new((-0.5 * signed * signed).exp() / n as f64, 0.0)
        })
        .collect();
    FftPlannerScalar::new().plan_fft_inverse(n).process(&mut bins);
    let mut outside: f64 = bins[1..].iter().map(|weight| weight.re.abs()).sum();
    let mut taps = vec![bins[0].re];
    while outside > KERNEL_TAIL {
        let next = taps.len();
        if 2 * next + 1 > n {
            return None;
        }
        outside -= 2.0 * bins[next].re.abs();
        taps.push(bins[next].re);
    }
    // What was cut off is given back in proportion, so that a constant stays exactly what it was.
    let sum = taps[0] + 2.0 * taps[1..].iter().sum::<f64>();
    Some(taps.iter().map(|tap| (tap / sum) as f32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(settings: Settings) -> Options {
        Options::new(settings).unwrap()
    }

    #[test]
    fn the_default_cutoff_needs_a_short_kernel_at_any_common_size() {
        for size in [(869, 565), (640, 480), (97, 61), (1920, 1080)] {
            let Recipe::Separable { kernel_x, kernel_y } = Recipe::choose(size, &Options::default()) else {
                panic!("{size:?} should be separable");
            };
            assert!(kernel_x.len() < 30 && kernel_y.len() < 30, "{size:?}");
        }
    }

    #[test]
    fn kernels_longer_than_the_side_take_the_transform() {
        assert_eq!(Recipe::choose((11, 3), &Options::default()), Recipe::Transform);
        let slow = options(Settings {
            delta: Some(1.0),
            ..Settings::default()
        });
        assert_eq!(Recipe::choose((869, 565), &slow), Recipe::Transform);
    }

    #[test]
    fn gains_and_offsets_that_single_precision_cannot_hold_take_the_transform() {
        let steep = options(Settings {
            r_high: 100.0,
            ..Settings::default()
        });
        let dark = options(Settings {
            eps: 1e-9,
            ..Settings::default()
        });
        assert_eq!(Recipe::choose((869, 565), &steep), Recipe::Transform);
        assert_eq!(Recipe::choose((869, 565), &dark), Recipe::Transform);
    }

    #[test]
    fn a_kernel_sums_to_one_and_has_the_width_of_its_gaussian() {
        let taps = half_kernel(900, 27.0).unwrap();
        let taps: Vec<f64> = taps.into_iter().map(f64::from).collect();
        let sum = taps[0] + 2.0 * taps[1..].iter().sum::<f64>();
        let variance: f64 = 2.0
            * taps
                .iter()
                .enumerate()
                .map(|(i, tap)| (i * i) as f64 * tap)
                .sum::<f64>();
        let sigma_px = 900.0 / (2.0 * std::f64::consts::PI * 27.0);
        assert!((sum - 1.0).abs() < 1e-6);
        assert!((variance.sqrt() - sigma_px).abs() < 1e-3);
    }

    #[test]
    fn a_cutoff_beyond_all_bins_needs_no_neighbours() {
        assert_eq!(half_kernel(64, 1e6).unwrap(), [1.0]);
        assert_eq!(half_kernel(1, 1.0).unwrap(), [1.0]);
    }
}
