//! The Fourier transforms of one axis of a plane.

use super::prime::{PrimeBuffers, PrimeSplit};
use super::{Direction, twiddle};
use crate::fft::{self, Complex, Ffts};

/// Transforms of contiguous lines of one length.
pub(super) struct AxisTransform {
    ffts: Ffts<f32>,
    /// For a length with a large prime factor.
    prime: Option<PrimeSplit>,
    /// `exp(-iπk/2N)`.
    pub(super) twiddles: Vec<Complex<f32>>,
}

/// Buffers for the transforms of any axis.
#[derive(Default)]
pub(super) struct AxisBuffers {
    scratch: Vec<Complex<f32>>,
    prime: PrimeBuffers,
}

impl AxisTransform {
    pub(super) fn new(length: usize) -> Self {
        let twiddles = (0..length).map(|k| {
            let twiddle = twiddle(k, length);
            Complex::new(twiddle.re as f32, twiddle.im as f32)
        });
        Self {
            ffts: fft::single(length),
            prime: PrimeSplit::new(length),
            twiddles: twiddles.collect(),
        }
    }

    /// Transforms lines in place.
    pub(super) fn process(
        &self,
        lines: &mut [Complex<f32>],
        direction: Direction,
        buffers: &mut AxisBuffers,
    ) {
        if let Some(prime) = &self.prime {
            return prime.process(lines, direction, &mut buffers.prime);
        }
        if buffers.scratch.len() < self.ffts.scratch {
            buffers.scratch.resize(self.ffts.scratch, Complex::default());
        }
        let fft = match direction {
            Direction::Forward => &self.ffts.forward,
            Direction::Inverse => &self.ffts.inverse,
        };
        fft.process_with_scratch(lines, &mut buffers.scratch);
    }
}
