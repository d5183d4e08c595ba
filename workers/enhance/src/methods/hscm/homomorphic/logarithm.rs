//! The logarithm of a row of luma in f32.

use crate::elementary::ln;
use crate::methods::hscm::luma::Luma;

/// `ln(code / white + eps)`.
#[derive(Clone, Copy)]
pub(super) struct Logarithm {
    scale: f32,
    eps: f32,
}

impl Logarithm {
    pub(super) fn new(luma: &Luma, eps: f64) -> Self {
        Self {
            scale: 1.0 / luma.white() as f32,
            eps: eps as f32,
        }
    }

    #[inline(always)]
    pub(super) fn row(self, codes: &[u32], logs: &mut [f32]) {
        // Codes stay below 2^26, and vector units have only the signed conversion.
        for (log, &code) in logs.iter_mut().zip(codes) {
            *log = ln(code as i32 as f32 * self.scale + self.eps);
        }
    }
}
