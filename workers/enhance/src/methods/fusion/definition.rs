//! Constants and gains of the definition, shared by both variants.

use imaging::Rgb8;
use spec::Fusion;

/// δ of the normalized weights.
pub(super) const WEIGHT_FLOOR: f64 = 0.1;
/// Distances in CIE Lab are divided by the lightness of white.
pub(super) const SALIENCY_SCALE: f64 = 1e-2;
pub(super) const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Levels of the pyramids for a picture of this size.
pub(super) fn count_levels(most: usize, width: usize, height: usize) -> usize {
    most.clamp(1, 1 + width.min(height).ilog2() as usize)
}

/// The fused picture and its gains.
pub(super) struct Fused {
    pub(super) picture: Rgb8,
    /// Gains of the gray world.
    pub(super) balance: [f64; 3],
    /// Gain of input 2 for differences.
    pub(super) detail: f64,
}

/// Coefficients of the compensation, `a max(m_G - m, 0)` of red, green and blue.
pub(super) fn compensation(parameters: &Fusion, means: [f64; 3]) -> [f64; 3] {
    let missing = means.map(|mean| (means[1] - mean).max(0.0));
    [
        parameters.red_gain * missing[0],
        0.0,
        parameters.blue_gain * missing[2],
    ]
}

/// Gains of the gray world.
pub(super) fn balance(means: [f64; 3]) -> [f64; 3] {
    let mean = means.iter().sum::<f64>() / 3.0;
    means.map(|own| if own > 0.0 { mean / own } else { 1.0 })
}
