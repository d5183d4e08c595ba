//! The logarithm of a row of luma, in single precision.

use super::TABLE1_LUMA_MIN;
use crate::elementary::ln;
use crate::hscm::luma::Luma;
use crate::hscm::options::{Options, Profile};

/// `ln(max(code / white, least) + offset)`.
#[derive(Clone, Copy)]
pub(super) struct Logarithm {
    scale: f32,
    least: f32,
    offset: f32,
}

impl Logarithm {
    pub(super) fn new(luma: &Luma, options: &Options) -> Self {
        let (least, offset) = match options.settings().profile {
            Profile::Standard => (0.0, options.settings().eps as f32),
            Profile::Table1 => (TABLE1_LUMA_MIN as f32, 0.0),
        };
        Self {
            scale: 1.0 / luma.white() as f32,
            least,
            offset,
        }
    }

    #[inline(always)]
    pub(super) fn row(self, codes: &[u32], logs: &mut [f32]) {
        let Self { scale, least, offset } = self;
        // Codes stay below 2^26, and the signed conversion is the one that vector units have.
        for (log, &code) in logs.iter_mut().zip(codes) {
            *log = ln((code as i32 as f32 * scale).max(least) + offset);
        }
    }
}
