//! Forward scatter: light that leaves its ray by a small angle and arrives at another pixel.
//!
//! Scatter (the Jaffe–McGlamery form): every source pixel y spreads its light, `F(x) = Σ_y U(y) K(x, y; γ(y))`, which conserves
//! energy. Gather (the simplified form): every pixel x collects with its kernel, `F(x) = Σ_y K(x, y; γ(x)) I(y)`; a uniform field
//! stays uniform. They are adjoint to each other. The frame is a mirror box, so that K is diagonal under the cosine transform:
//! `K(γ) = DCT⁻¹ diag(H(γ)) DCT`.
//!
//! Neither form includes occlusion: background light that leaks over a near object is about four times too strong. The first form
//! has an occlusion-aware variant: it divides the frame into layers and stops light from behind a near object at its gate.

mod basis;
mod bound;
mod buffers;
mod cache;
mod channel;
mod chebyshev;
mod decimation;
mod gate;
mod gated;
mod layer;
mod nodes;
mod pass;
mod reference;
mod spectra;
mod spread;

pub use bound::{Bound, Errors, ScaleLight};
pub use cache::KernelCache;
pub(crate) use channel::Channel;
pub use chebyshev::{gather, scatter};
pub(crate) use chebyshev::{gather_channels, scatter_channels};
pub use decimation::Coarseness;
pub(crate) use gate::{Gate, OPAQUE_GATE};
pub(crate) use gated::{Source, gated_channels};
pub(crate) use layer::{FILL_LEAST, fill_gamma_px};
pub use nodes::{Kernels, Nodes};
pub(crate) use nodes::{place, scale_at};
pub(crate) use reference::scatter_behind_gates;
pub use reference::{MAX_REFERENCE_PIXELS, gather_reference, scatter_reference};

/// Largest kernel scale in frame sides: beyond it the kernel is flat across the frame.
const MAX_GAMMA_IN_SIDES: f64 = 4.0;

/// The widest kernel of a frame, in pixels: `4 max(W, H)`.
#[must_use]
pub fn widest_px(width: usize, height: usize) -> f64 {
    MAX_GAMMA_IN_SIDES * width.max(height) as f64
}
