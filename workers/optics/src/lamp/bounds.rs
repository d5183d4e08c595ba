//! Bounds of the light of lamps and of its rounding, from the coarse geometry of a view alone.
//!
//! Rays of a tile are inside a cone about its center. For each tile and lamp, distances, angles and paths are bounded over that
//! cone and a segment of its rays; attenuation, beam profile and phase function are evaluated at the end of these intervals with
//! the largest value. Surfaces may face any lamp, and shadows are ignored. The rounding of f32 follows from the same intervals:
//! every operation of the fast form errs by at most one [`STEP`] of its result, and the errors are propagated to first order.

mod airlight;
mod cone;
mod factor;
mod profile;
mod surface;

pub use airlight::{AirlightBounds, bound_airlight};
pub use surface::{SurfaceBounds, bound_irradiance};

/// One rounding of f32, as a share of the result: 2⁻²⁴.
const STEP: f64 = 6e-8;
/// Relative error of [`fade`](crate::elementary::fade).
const FADE: f64 = 3e-7;

/// Largest value of `x e^{−x}` between two exponents.
fn most_decayed(least: f64, most: f64) -> f64 {
    let x = 1.0f64.clamp(least, most.max(least));
    x * (-x).exp()
}
