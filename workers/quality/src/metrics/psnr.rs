//! PSNR: `10 log10(255² / MSE)` in dB over the 8-bit codes of all three channels, against a clean picture.

use crate::work::MetricInput;

/// Largest value, also for equal pictures: a single code off by one in 64 million pixels is at 131 dB, and higher
/// values are not distinguished.
pub(crate) const CAP_DB: f64 = 100.0;

/// Peak signal-to-noise ratio, 0..=100 dB.
pub(crate) fn psnr(work: &MetricInput) -> f64 {
    let (codes, clean) = (work.picture().data(), work.clean().data());
    let squares: u64 = codes
        .iter()
        .zip(clean)
        .map(|(&a, &b)| u64::from(a.abs_diff(b)).pow(2))
        .sum();
    if squares == 0 {
        return CAP_DB;
    }
    let mean = squares as f64 / codes.len() as f64;
    (10.0 * (255.0 * 255.0 / mean).log10()).min(CAP_DB)
}
