//! The inputs of a network.

use imaging::Plane;

/// Optional inputs of a model, each of the frame's size.
#[derive(Debug, Clone, Copy, Default)]
pub struct ModelInputs<'a> {
    /// Standard normal samples, see [`crate::noise`]; zeros if absent. Ignored by models without a noise input.
    pub noise: Option<&'a Plane<f32>>,
    /// The range of each pixel, `1 − exp(−Z / `[`crate::RANGE_SCALE_M`]`)`, and 1 for holes. Required by models with a
    /// range input, ignored by others.
    pub range: Option<&'a Plane<f32>>,
}
