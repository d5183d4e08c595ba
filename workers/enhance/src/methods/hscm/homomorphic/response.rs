//! Frequency response of the decimation.

/// The largest gain of a component beyond a quarter of the sampling rate, along an axis with a Gaussian of this σ: the
/// maximum of `sin⁶(δ/2) exp(-δ² σ²/2)` over the distance δ to the folding frequency.
pub(super) fn aliasing(sigma_px: f64) -> f64 {
    0.168 / sigma_px.powi(6)
}

/// The response of the two binomials at bin k of n.
pub(super) fn response(k: usize, n: usize) -> f64 {
    (std::f64::consts::PI * k as f64 / n as f64).cos().powi(12)
}
