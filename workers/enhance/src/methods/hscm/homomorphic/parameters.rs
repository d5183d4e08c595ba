//! Parameters of the filter.

/// Gain of high frequencies.
pub(super) const R_HIGH: f64 = 2.5;

/// Gain of low frequencies.
pub(super) const R_LOW: f64 = 0.5;
