//! Fourier transforms of complex lines.
//!
//! The only planner for both precisions: the library is generic, and every crate with a planner would compile all of it
//! again.

pub use rustfft::Fft;
pub use rustfft::num_complex::Complex;

use std::sync::Arc;

use rustfft::{FftNum, FftPlanner, FftPlannerScalar};

/// Both transforms of one length: `X[k] = Σ_n x[n] exp(∓2πi k n/N)`. Neither is normalized.
pub struct Ffts<T: FftNum> {
    /// With the minus sign.
    pub forward: Arc<dyn Fft<T>>,
    /// With the plus sign; applied after `forward` it scales every value by N.
    pub inverse: Arc<dyn Fft<T>>,
    /// Scratch length sufficient for either in place.
    pub scratch: usize,
}

impl<T: FftNum> Ffts<T> {
    fn new(forward: Arc<dyn Fft<T>>, inverse: Arc<dyn Fft<T>>) -> Self {
        let scratch = forward
            .get_inplace_scratch_len()
            .max(inverse.get_inplace_scratch_len());
        Self {
            forward,
            inverse,
            scratch,
        }
    }
}

/// Transforms in f32 with the vector instructions of this CPU.
#[must_use]
pub fn single(length: usize) -> Ffts<f32> {
    let mut planner = FftPlanner::new();
    Ffts::new(planner.plan_fft_forward(length), planner.plan_fft_inverse(length))
}

/// Transforms in f64, for references: without vector instructions, so that every CPU computes the same bits.
#[must_use]
pub fn double(length: usize) -> Ffts<f64> {
    let mut planner = FftPlannerScalar::new();
    Ffts::new(planner.plan_fft_forward(length), planner.plan_fft_inverse(length))
}

/// The inverse of [`double`], without planning the forward transform.
#[must_use]
pub fn double_inverse(length: usize) -> Arc<dyn Fft<f64>> {
    FftPlannerScalar::new().plan_fft_inverse(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_precisions_are_the_definition_and_undo_themselves() {
        for length in [1, 2, 7, 12, 31, 96] {
            let line: Vec<_> = (0..length)
                .map(|n| Complex::new((n as f64 * 0.7).sin(), (n as f64 * 1.3).cos()))
                .collect();
            let term = |k: usize, n: usize| {
                let turn = (k * n % length) as f64 / length as f64;
                line[n] * Complex::from_polar(1.0, -std::f64::consts::TAU * turn)
            };
            let expected: Vec<Complex<f64>> = (0..length)
                .map(|k| (0..length).map(|n| term(k, n)).sum())
                .collect();

            let (exact, fast) = (double(length), single(length));
            let mut bins = line.clone();
            exact.forward.process(&mut bins);
            let mut fast_bins: Vec<_> = line
                .iter()
                .map(|v| Complex::new(v.re as f32, v.im as f32))
                .collect();
            fast.forward
                .process_with_scratch(&mut fast_bins, &mut vec![Complex::default(); fast.scratch]);
            let widened = |v: Complex<f32>| Complex::new(f64::from(v.re), f64::from(v.im));
            for k in 0..length {
                assert!((bins[k] - expected[k]).norm() < 1e-12 * length as f64);
                assert!((widened(fast_bins[k]) - expected[k]).norm() < 1e-6 * length as f64);
            }
            let mut alone = bins.clone();
            double_inverse(length).process(&mut alone);
            exact
                .inverse
                .process_with_scratch(&mut bins, &mut vec![Complex::default(); exact.scratch]);
            assert_eq!(alone, bins);
            fast.inverse.process(&mut fast_bins);
            for n in 0..length {
                let scale = 1.0 / length as f64;
                assert!((bins[n] * scale - line[n]).norm() < 1e-13);
                assert!((widened(fast_bins[n]) * scale - line[n]).norm() < 1e-6);
            }
        }
    }
}
