//! Error bounds of f32 arithmetic (Higham 2002, section 3.1).

/// Largest relative error of one rounding to f32.
const UNIT: f64 = f32::EPSILON as f64 / 2.0;
/// Largest absolute error of one rounding to f32 where the result is subnormal.
const SUBNORMAL: f64 = 7.1e-46;

/// Largest relative error of n roundings: `n u/(1 - n u)`.
pub(crate) fn relative(roundings: f64) -> f64 {
    roundings * UNIT / (1.0 - roundings * UNIT)
}

/// Largest absolute error of n roundings of values whose magnitudes sum to at most `peak`.
pub(crate) fn absolute(roundings: f64, peak: f64) -> f64 {
    relative(roundings) * peak + roundings * SUBNORMAL
}
