//! Homomorphic filter: illumination varies slowly and is multiplicative, so its logarithm is a low frequency to
//! attenuate.
//!
//! `l = ln(y + eps)`; `x = IDFT(H · DFT(l))`; `s = 255 exp(min(x, 0))`, rounded, with `H(u, v) = (r_high - r_low)(1 -
//! exp(-(u² + v²) / (2 delta²))) + r_low`.
//!
//! Symbols: `y` luma in 0..=1; `r_high` and `r_low` the gains of high and low frequencies; `u`, `v` signed bin numbers of
//! the rows and columns of the padded picture; `delta` the cutoff in bins, the same on both axes (so the cut is
//! elliptical in cycles per pixel unless the picture is square). [`Filter`] holds the parameters. Each side is padded at its end to the next size without a prime factor above 5 (fast
//! to transform).
//!
//! [`Variant::Reference`] is the definition in f64. [`Variant::Fast`] uses that the filter is `r_high · l - (r_high -
//! r_low) · (Gaussian ∗ l)`, that the circular Gaussian is separable, and that it removes the upper half of the
//! frequencies if it is several pixels wide: two short passes in f32, decimated where the error is far below a code.
//! [`FilterRecipe`] selects the implementation.

mod decimated;
mod logarithm;
mod narrowed;
mod padding;
mod parameters;
mod recipe;
mod reference;
mod response;
mod separable;

use imaging::{Plane, vectorized};

pub use padding::padded_side;
pub use recipe::{FilterRecipe, PassKernels};

use crate::elementary::exp;
use crate::methods::hscm::luma::Luma;
use crate::variant::Variant;
pub use parameters::Filter;

/// Logarithms within this span are one value: a transform would leave noise on both sides of a rounding tie.
const FLAT_LOG: f64 = 1e-6;
/// The filtered luma, 8 bit. `luma` must not be empty.
#[must_use]
pub fn homomorphic(luma: &Luma, filter: &Filter, variant: Variant) -> Plane<u8> {
    let recipe = choose(luma, filter, variant);
    if let Some(exact) = exact(&recipe, luma, filter) {
        return exact.map(|&x| reference::code(x));
    }
    let (width, height) = luma.codes().size();
    let mut codes = Plane::filled(width, height, 0u8);
    // Compiled separately: a closure with two callers is not inlined into either.
    sweep(&recipe, luma, filter, &mut |y: usize, row: &[f32]| {
        let codes = codes.row_mut(y);
        vectorized!(encode(row, codes));
    });
    codes
}

/// The filtered logarithm in f64, for recipes that need it.
fn exact(recipe: &FilterRecipe, luma: &Luma, filter: &Filter) -> Option<Plane<f64>> {
    match recipe {
        FilterRecipe::Flat => Some(luma.map(|y| filter.gain_low * (y + filter.eps).ln())),
        FilterRecipe::Transform => Some(reference::filtered_log(luma, filter)),
        FilterRecipe::Separable(_) | FilterRecipe::Decimated(_) | FilterRecipe::Narrowed(_) => None,
    }
}

/// Calls `finish` with each row of the filtered logarithm, for recipes of two passes.
fn sweep(recipe: &FilterRecipe, luma: &Luma, filter: &Filter, finish: &mut impl FnMut(usize, &[f32])) {
    match recipe {
        FilterRecipe::Flat | FilterRecipe::Transform => {}
        FilterRecipe::Separable(kernels) => vectorized!(separable::sweep(luma, filter, kernels, finish)),
        FilterRecipe::Decimated(kernels) => vectorized!(decimated::sweep(luma, filter, kernels, finish)),
        FilterRecipe::Narrowed(kernels) => vectorized!(narrowed::sweep(luma, filter, kernels, finish)),
    }
}

/// `255 exp(min(x, 0))` along a row, rounded.
#[inline(always)]
fn encode(row: &[f32], codes: &mut [u8]) {
    for (code, &x) in codes.iter_mut().zip(row) {
        *code = floor_code(255.0 * exp(x.min(0.0)) + 0.5);
    }
}

/// The integer part of a value in 0..=255.5. Adding 2^23 rounds to an integer in the low bits; a cast is defined for
/// every float and would cost five times as long.
#[inline(always)]
fn floor_code(value: f32) -> u8 {
    const ROUND: f32 = 8_388_608.0;
    let rounded = (value + ROUND) - ROUND;
    let floor = if rounded > value { rounded - 1.0 } else { rounded };
    (floor + ROUND).to_bits() as u8
}

/// The filtered logarithm `x` before the exponential. `luma` must not be empty.
#[must_use]
pub fn filtered_log(luma: &Luma, filter: &Filter, variant: Variant) -> Plane<f32> {
    filtered_by(&choose(luma, filter, variant), luma, filter)
}

/// The filtered logarithm by a recipe chosen for this picture and filter.
#[must_use]
pub fn filtered_by(recipe: &FilterRecipe, luma: &Luma, filter: &Filter) -> Plane<f32> {
    if let Some(exact) = exact(recipe, luma, filter) {
        return exact.map(|&x| x as f32);
    }
    let (width, height) = luma.codes().size();
    let mut logs = Plane::filled(width, height, 0.0f32);
    sweep(recipe, luma, filter, &mut |y: usize, row: &[f32]| {
        logs.row_mut(y).copy_from_slice(row)
    });
    logs
}

fn choose(luma: &Luma, filter: &Filter, variant: Variant) -> FilterRecipe {
    let (low, high) = luma.extremes();
    let is_flat = (high + filter.eps).ln() - (low + filter.eps).ln() < FLAT_LOG;
    match variant {
        _ if is_flat => FilterRecipe::Flat,
        Variant::Reference => FilterRecipe::Transform,
        Variant::Fast => FilterRecipe::choose(luma.codes().size(), filter),
    }
}

#[cfg(test)]
mod tests {
    use super::floor_code;

    #[test]
    fn codes_are_cut_like_a_cast_does() {
        for i in 0..=255u16 {
            let whole = f32::from(i);
            for value in [
                whole,
                whole + 0.25,
                whole + 0.5,
                f32::from_bits((whole + 0.5).to_bits() - 1),
            ] {
                assert_eq!(floor_code(value), value as u8, "{value}");
            }
            let below = f32::from_bits(whole.max(0.25).to_bits() - 1);
            assert_eq!(floor_code(below), below as u8, "{below}");
        }
    }
}
