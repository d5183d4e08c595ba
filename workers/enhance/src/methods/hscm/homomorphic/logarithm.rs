//! The logarithm of a row of luma in f32.

use crate::elementary::ln;
use crate::methods::hscm::luma::Luma;

/// `ln(code / white + eps)`.
#[derive(Clone, Copy)]
pub(super) struct Logarithm {
    scale: f32,
}

impl Logarithm {
    pub(super) fn new(luma: &Luma) -> Self {
        let scale = 1.0 / luma.white() as f32;
        Self { scale }
    }

    #[inline(always)]
    pub(super) fn row(self, codes: &[u32], logs: &mut [f32]) {
        // Codes stay below 2^26, and vector units have only the signed conversion.
        for (log, &code) in logs.iter_mut().zip(codes) {
            *log = ln(code as i32 as f32 * self.scale + EPS as f32);
        }
    }
}

/// Added to the luma, so that black has a logarithm.
pub(super) const EPS: f64 = 0.01;

/// The logarithm of the luma `y`.
pub(super) fn log(y: f64) -> f64 {
    (y + EPS).ln()
}
