//! Fourier and cosine transforms.

pub mod dct;
pub mod fft;
