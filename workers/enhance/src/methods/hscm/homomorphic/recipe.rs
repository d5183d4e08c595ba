//! Selects the implementation of the fast variant from the size and the cutoff.

use imaging::fft::{self, Complex};

use super::padding::padded_side;
use super::parameters::Filter;
use super::response::{aliasing, response};

/// Share of the circular Gaussian's weight that may be truncated, times the swing of the filter. With the defaults, a swing
/// of 4.6, the share is 1e-6 and the filtered logarithm moves by at most 1e-5: one code in several hundred is close enough to
/// a tie to change.
const KERNEL_TAIL: f64 = 4.615e-6;
/// The same for the decimated kernel, where division by the decimation response adds a small kink to the spectrum and a
/// long faint tail to the kernel. The filtered logarithm moves by at most 1.4e-4.
const KERNEL_TAIL_DECIMATED: f64 = 1.3845e-4;
/// Largest sum of both kernel radii. Beyond it the transform is cheaper than the two passes.
const RADII_MAX: usize = 300;

/// Largest change of the filtered logarithm by aliasing in the worst picture: stripes of black and white at the worst
/// frequency. The method's tolerance is 2e-3; pictures of scenes show a few 1e-6.
const ALIASING_MAX: f64 = 1.5e-3;

/// Half kernels of the two passes, center first.
#[derive(Debug, Clone, PartialEq)]
pub struct PassKernels {
    /// Weights along a row.
    pub x: Vec<f32>,
    /// Weights along a column.
    pub y: Vec<f32>,
}

/// Implementation of the filter. A plain value: planning can be tested without filtering.
#[derive(Debug, Clone, PartialEq)]
pub enum FilterRecipe {
    /// All logarithms are equal and are scaled by `r_low`.
    Flat,
    /// Two passes.
    Separable(PassKernels),
    /// Two passes, decimated by two along both axes.
    Decimated(PassKernels),
    /// Two passes, decimated by two along the rows.
    Narrowed(PassKernels),
    /// The two-dimensional transform in double precision.
    Transform,
}

impl FilterRecipe {
    /// The cheapest recipe for a picture of (width, height), at least 1×1 and not flat.
    #[must_use]
    pub fn choose(size: (usize, usize), filter: &Filter) -> Self {
        Self::decimated(size, filter)
            .or_else(|| Self::narrowed(size, filter))
            .or_else(|| Self::separable(size, filter))
            .unwrap_or(Self::Transform)
    }

    /// Two passes; `None` if a kernel would not fit or the transform is cheaper.
    pub(super) fn separable((width, height): (usize, usize), filter: &Filter) -> Option<Self> {
        let x = half_kernel(padded_side(width), filter, 1)?;
        let y = half_kernel(padded_side(height), filter, 1)?;
        (x.len() + y.len() - 2 <= RADII_MAX).then_some(Self::Separable(PassKernels { x, y }))
    }

    /// Two decimated passes; `None` if a side cannot be halved, a kernel would not fit, or aliasing might be visible.
    fn decimated((width, height): (usize, usize), filter: &Filter) -> Option<Self> {
        let sides = [padded_side(width), padded_side(height)];
        if !is_halved(&sides, filter) {
            return None;
        }
        let [x, y] = sides.map(|side| half_kernel(side, filter, 2));
        Some(Self::Decimated(PassKernels { x: x?, y: y? }))
    }

    /// Two passes over rows of half the length; `None` as for [`Self::decimated`], or if the transform is cheaper.
    fn narrowed((width, height): (usize, usize), filter: &Filter) -> Option<Self> {
        let side = padded_side(width);
        if !is_halved(&[side], filter) {
            return None;
        }
        let x = half_kernel(side, filter, 2)?;
        let y = half_kernel(padded_side(height), filter, 1)?;
        (x.len() + y.len() - 2 <= RADII_MAX).then_some(Self::Narrowed(PassKernels { x, y }))
    }
}

/// Whether every second sample of these padded sides is enough.
fn is_halved(sides: &[usize], filter: &Filter) -> bool {
    let sigma_px = |side: usize| side as f64 / (2.0 * std::f64::consts::PI * filter.delta);
    // A component aliases before the Gaussian, and its image after it.
    let gain: f64 = sides.iter().map(|&side| 2.0 * aliasing(sigma_px(side))).sum();
    sides.iter().all(|side| side % 2 == 0) && filter.swing() * gain <= ALIASING_MAX
}

/// The circular convolution kernel with the transform `exp(-k² / (2 delta²))` on every `step`-th (1 or 2) of `n`
/// samples, divided by the decimation response for step 2, from its center outward until less than [`KERNEL_TAIL`] or
/// [`KERNEL_TAIL_DECIMATED`] remains; `None` if more than half the side would be needed.
fn half_kernel(side: usize, filter: &Filter, step: usize) -> Option<Vec<f32>> {
    let n = side / step;
    let bins = (0..n).map(|k| {
        let k = k.min(n - k);
        let signed = k as f64 / filter.delta;
        let lost = if step == 1 { 1.0 } else { response(k, side) };
        Complex::new((-0.5 * signed * signed).exp() / lost / n as f64, 0.0)
    });
    let mut bins: Vec<Complex<f64>> = bins.collect();
    fft::double_inverse(n).process(&mut bins);
    let mut outside: f64 = bins[1..].iter().map(|weight| weight.re.abs()).sum();
    let mut taps = vec![bins[0].re];
    let tail = [KERNEL_TAIL, KERNEL_TAIL_DECIMATED][step - 1] / filter.swing().max(f64::MIN_POSITIVE);
    while outside > tail {
        let next = taps.len();
        if 2 * next + 1 > n {
            return None;
        }
        outside -= 2.0 * bins[next].re.abs();
        taps.push(bins[next].re);
    }
    // Renormalize after truncation, so that constants are exact.
    let sum = taps[0] + 2.0 * taps[1..].iter().sum::<f64>();
    Some(taps.iter().map(|tap| (tap / sum) as f32).collect())
}

#[cfg(test)]
mod tests {
    use spec::Hscm;

    use super::*;

    fn chosen(size: (usize, usize)) -> FilterRecipe {
        FilterRecipe::choose(size, &Filter::new(&Hscm::default(), size.0))
    }

    /// The default filter with another cutoff.
    fn with_delta(delta: f64) -> Filter {
        Filter {
            delta,
            ..Filter::new(&Hscm::default(), 1)
        }
    }

    #[test]
    fn the_default_cutoff_needs_a_short_kernel_on_every_second_sample() {
        for size in [(869, 565), (640, 480), (1280, 960), (800, 800)] {
            let FilterRecipe::Decimated(PassKernels { x, y }) = chosen(size) else {
                panic!("{size:?} should be decimated");
            };
            assert!(x.len() < 16 && y.len() < 16, "{size:?}");
        }
    }

    #[test]
    fn a_wide_picture_keeps_every_row() {
        for size in [(1280, 720), (1920, 1080)] {
            let FilterRecipe::Narrowed(PassKernels { x, y }) = chosen(size) else {
                panic!("{size:?} should be narrowed");
            };
            assert!(x.len() < 16 && y.len() < 16, "{size:?}");
        }
    }

    #[test]
    fn odd_sides_and_narrow_gaussians_keep_every_sample() {
        // 75 is padded to 75; a cutoff of 60 bins gives a Gaussian of 2.4 by 1.5 pixels.
        for recipe in [
            chosen((75, 96)),
            FilterRecipe::choose((869, 565), &with_delta(60.0)),
        ] {
            assert!(matches!(recipe, FilterRecipe::Separable(_)), "{recipe:?}");
        }
    }

    #[test]
    fn kernels_longer_than_the_side_take_the_transform() {
        assert_eq!(chosen((11, 3)), FilterRecipe::Transform);
        assert_eq!(
            FilterRecipe::choose((869, 565), &with_delta(1.0)),
            FilterRecipe::Transform
        );
    }

    #[test]
    fn a_kernel_sums_to_one_and_has_the_width_of_its_gaussian() {
        let taps = half_kernel(900, &with_delta(27.0), 1).unwrap();
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
        assert_eq!(half_kernel(64, &with_delta(1e6), 1).unwrap(), [1.0]);
        assert_eq!(half_kernel(1, &with_delta(1.0), 1).unwrap(), [1.0]);
    }
}
