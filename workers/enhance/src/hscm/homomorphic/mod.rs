//! Homomorphic filter: illumination is slow and multiplies, so its logarithm is a low frequency and is turned down.
//!
//! `l = ln(y + eps)`; `x = IDFT(H · DFT(l))`; `s = 255 exp(min(x, 0))`, rounded, with
//! `H(u, v) = (r_high - r_low)(1 - exp(-(u² + v²) / (2 delta²))) + r_low`.
//!
//! Symbols: `y` luma in 0..=1; `u`, `v` signed bin numbers of the rows and columns of the padded picture; `delta` the
//! cut-off in bins, the same on both axes (so the cut is elliptical in cycles per pixel unless the picture is
//! square). Each side is padded at its end to the next size without a prime factor above 5 (fast to transform).
//!
//! Two implementations. [`Variant::Reference`] is the definition in double precision. [`Variant::Fast`] uses that the
//! filter is `r_high · l - (r_high - r_low) · (Gaussian ∗ l)` and that the circular Gaussian is separable and short
//! at the usual cut-offs: two passes in single precision. [`Recipe`] says where this does not hold and the transform
//! is taken instead.

mod padding;
mod recipe;
mod reference;
mod separable;

use imaging::Plane;

pub use padding::padded_side;
pub use recipe::{EPS_MIN_SINGLE, KERNEL_TAIL, R_HIGH_MAX_SINGLE, RADII_MAX, Recipe};

use crate::hscm::luma::Luma;
use crate::hscm::options::{Options, Profile};
use crate::method::Variant;

/// Logarithms closer together than this are one value: a transform would leave noise on both sides of a rounding tie.
const FLAT_LOG: f64 = 1e-6;
/// Least luma of the table 1 profile, in place of `eps`.
const TABLE1_LUMA_MIN: f64 = 1e-5;

/// The filtered luma, 8 bit. `luma` must hold at least one pixel.
#[must_use]
pub fn homomorphic(luma: &Luma, options: &Options, variant: Variant) -> Plane<u8> {
    match choose(luma, options, variant) {
        Recipe::Flat => flat(luma, options).map(|&x| reference::code(x, options)),
        Recipe::Transform => reference::filtered_log(luma, options).map(|&x| reference::code(x, options)),
        Recipe::Separable { kernel_x, kernel_y } => separable::codes(luma, options, &kernel_x, &kernel_y),
    }
}

/// The filtered logarithm `x` itself, before the exponential. `luma` must hold at least one pixel.
#[must_use]
pub fn filtered_log(luma: &Luma, options: &Options, variant: Variant) -> Plane<f32> {
    match choose(luma, options, variant) {
        Recipe::Flat => flat(luma, options).map(|&x| x as f32),
        Recipe::Transform => reference::filtered_log(luma, options).map(|&x| x as f32),
        Recipe::Separable { kernel_x, kernel_y } => {
            separable::filtered_log(luma, options, &kernel_x, &kernel_y)
        }
    }
}

fn choose(luma: &Luma, options: &Options, variant: Variant) -> Recipe {
    if is_flat(luma, options) {
        return Recipe::Flat;
    }
    match variant {
        Variant::Reference => Recipe::Transform,
        Variant::Fast => Recipe::choose(luma.codes().size(), options),
    }
}

/// Whether the padded logarithm is one value.
fn is_flat(luma: &Luma, options: &Options) -> bool {
    let (low, high) = luma.extremes();
    let (mut low, mut high) = (log(low, options), log(high, options));
    let (width, height) = luma.codes().size();
    let padded = padded_side(width) > width || padded_side(height) > height;
    if options.settings().profile == Profile::Table1 && padded {
        (low, high) = (low.min(0.0), high.max(0.0));
    }
    high - low < FLAT_LOG
}

/// `r_low · l`: all that the filter does to a constant.
fn flat(luma: &Luma, options: &Options) -> Plane<f64> {
    let white = f64::from(luma.white());
    luma.codes()
        .map(|&code| options.settings().r_low * log(f64::from(code) / white, options))
}

/// The logarithm of the luma `y`.
fn log(y: f64, options: &Options) -> f64 {
    match options.settings().profile {
        Profile::Standard => (y + options.settings().eps).ln(),
        Profile::Table1 => y.max(TABLE1_LUMA_MIN).ln(),
    }
}
