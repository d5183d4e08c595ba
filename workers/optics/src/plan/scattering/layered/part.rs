//! A part of the light that one kernel spreads.

use crate::plan::passages::Through;

/// The light of one layer that one of its kernels spreads.
pub(super) struct Part {
    /// Kernel scales, pixels.
    pub(super) span: (f64, f64),
    /// Parts of it with the largest light of each.
    pub(super) bins: Vec<((f64, f64), f64)>,
    /// The gate in front.
    pub(super) way: Option<Way>,
    /// Scale at the range of the gate behind, whose light one of the kernels spreads.
    pub(super) passing: Option<f64>,
    /// The most of that light.
    pub(super) passing_light: f64,
}

/// The path of a layer's light through gates.
pub(super) struct Way {
    pub(super) through: Through,
    /// 0 of the narrow kernel, 1 of the wide one.
    pub(super) kernel: usize,
}
