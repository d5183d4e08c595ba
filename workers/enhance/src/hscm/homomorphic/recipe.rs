//! Which implementation the fast variant uses: chosen from the size and the options alone.

use rustfft::FftPlannerScalar;
use rustfft::num_complex::Complex;

use super::TABLE1_LUMA_MIN;
use super::decimated::{aliasing, response};
use super::padding::padded_side;
use crate::hscm::options::{Options, Profile, Settings};

/// Weight of the circular Gaussian that may be cut off, in parts of the whole. With logarithms in -4.6..=0 and
/// `r_high` 2.5 the filtered logarithm then moves by at most 1e-5: one code in several hundred is near enough to a
/// tie to change.
pub const KERNEL_TAIL: f64 = 1e-6;
/// The same on every second sample, where division by the response of leaving samples out puts a small kink into the
/// spectrum and a long faint tail to the kernel. The filtered logarithm moves by at most 1.4e-4.
pub const KERNEL_TAIL_DECIMATED: f64 = 3e-5;
/// Largest `r_high` of the single-precision passes. Rounding grows with `r_high · |ln eps|`: at this and
/// [`EPS_MIN_SINGLE`] it reaches a few 1e-4, well inside the 2e-3 that the filtered logarithm may be off.
pub const R_HIGH_MAX_SINGLE: f64 = 16.0;
/// Smallest `eps` of the single-precision passes, see [`R_HIGH_MAX_SINGLE`].
pub const EPS_MIN_SINGLE: f64 = 1e-6;
/// Largest sum of both kernel radii. Beyond it the transform costs less than the two passes.
pub const RADII_MAX: usize = 300;

/// Most that aliasing may change the filtered logarithm by, for the worst of all pictures: stripes of black and white at
/// the worst frequency. The method's tolerance is 2e-3; in pictures of scenes a few 1e-6 remain.
pub const ALIASING_MAX: f64 = 1.5e-3;

/// Half kernels of the two passes, center first.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernels {
    /// Weights along a row.
    pub x: Vec<f32>,
    /// Weights along a column.
    pub y: Vec<f32>,
}

/// How the filter is computed. A plain value: planning can be tested without filtering.
#[derive(Debug, Clone, PartialEq)]
pub enum Recipe {
    /// All logarithms are one value: they are scaled by `r_low`.
    Flat,
    /// Two passes.
    Separable(Kernels),
    /// Two passes on every second sample of every second row.
    Decimated(Kernels),
    /// The two-dimensional transform in double precision.
    Transform,
}

impl Recipe {
    /// The cheapest way to filter a picture of (width, height), at least 1×1, that is not flat.
    #[must_use]
    pub fn choose(size: (usize, usize), options: &Options) -> Self {
        let Settings {
            r_high, eps, profile, ..
        } = *options.settings();
        if r_high > R_HIGH_MAX_SINGLE || (profile == Profile::Standard && eps < EPS_MIN_SINGLE) {
            return Self::Transform;
        }
        Self::decimated(size, options)
            .or_else(|| Self::separable(size, options))
            .unwrap_or(Self::Transform)
    }

    /// Two passes; `None` where a kernel would not fit, or the transform costs less.
    #[must_use]
    pub fn separable((width, height): (usize, usize), options: &Options) -> Option<Self> {
        let delta = options.delta_bins(width);
        let x = half_kernel(padded_side(width), delta, 1)?;
        let y = half_kernel(padded_side(height), delta, 1)?;
        (x.len() + y.len() - 2 <= RADII_MAX).then_some(Self::Separable(Kernels { x, y }))
    }

    /// Two passes on every second sample; `None` where a side cannot be halved, a kernel would not fit, or aliasing
    /// might show.
    #[must_use]
    pub fn decimated((width, height): (usize, usize), options: &Options) -> Option<Self> {
        let sides = [padded_side(width), padded_side(height)];
        if sides.iter().any(|side| side % 2 == 1) {
            return None;
        }
        let Settings {
            r_high,
            r_low,
            eps,
            profile,
            ..
        } = *options.settings();
        let darkest = match profile {
            Profile::Standard => eps,
            Profile::Table1 => TABLE1_LUMA_MIN,
        };
        // Stripes swing by half of the range; a component aliases before the Gaussian, and its image behind it.
        let swing = 0.5 * darkest.ln().abs().max((1.0 + eps).ln()) * (r_high - r_low);
        let delta = options.delta_bins(width);
        let gains = sides.map(|side| 2.0 * aliasing(side as f64 / (2.0 * std::f64::consts::PI * delta)));
        if swing * (gains[0] + gains[1]) > ALIASING_MAX {
            return None;
        }
        let [x, y] = sides.map(|side| half_kernel(side, delta, 2));
        Some(Self::Decimated(Kernels { x: x?, y: y? }))
    }
}

/// The circular convolution kernel on every `step`-th (1 or 2) of `n` samples whose transform is `exp(-k² / (2 delta²))`,
/// over the response of leaving samples out where some are, from its center outward until less than [`KERNEL_TAIL`] or
/// [`KERNEL_TAIL_DECIMATED`] remains; `None` when more than half the side would be needed.
fn half_kernel(side: usize, delta: f64, step: usize) -> Option<Vec<f32>> {
    let n = side / step;
    let bin = |k: usize| {
        let k = k.min(n - k);
        let signed = k as f64 / delta;
        let lost = if step == 1 { 1.0 } else { response(k, side) };
        Complex::new((-0.5 * signed * signed).exp() / lost / n as f64, 0.0)
    };
    let mut bins: Vec<Complex<f64>> = (0..n).map(bin).collect();
    FftPlannerScalar::new().plan_fft_inverse(n).process(&mut bins);
    let mut outside: f64 = bins[1..].iter().map(|weight| weight.re.abs()).sum();
    let mut taps = vec![bins[0].re];
    let tail = [KERNEL_TAIL, KERNEL_TAIL_DECIMATED][step - 1];
    while outside > tail {
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
    fn the_default_cutoff_needs_a_short_kernel_on_every_second_sample() {
        for size in [(869, 565), (640, 480), (1280, 960), (800, 800)] {
            let Recipe::Decimated(Kernels { x, y }) = Recipe::choose(size, &Options::default()) else {
                panic!("{size:?} should be decimated");
            };
            assert!(x.len() < 16 && y.len() < 16, "{size:?}");
        }
    }

    #[test]
    fn odd_sides_and_narrow_gaussians_keep_every_sample() {
        // 75 is padded to itself; a cut-off of 60 bins leaves a Gaussian of 2.4 by 1.5 pixels.
        let narrow = options(Settings {
            delta: Some(60.0),
            ..Settings::default()
        });
        for (size, options) in [((75, 96), Options::default()), ((869, 565), narrow)] {
            assert!(
                matches!(Recipe::choose(size, &options), Recipe::Separable(_)),
                "{size:?}"
            );
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
        let taps = half_kernel(900, 27.0, 1).unwrap();
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
    fn a_cutoff_beyond_all_bins_needs_no_neighbors() {
        assert_eq!(half_kernel(64, 1e6, 1).unwrap(), [1.0]);
        assert_eq!(half_kernel(1, 1.0, 1).unwrap(), [1.0]);
    }
}
