//! Illumination residual: the share of the true illumination that an enhancement leaves in the picture.
//!
//! With y the logarithm of a picture's luminance, L that of the true illumination after a low-pass and R that of the
//! reflectance, β is the coefficient of L in the linear regression of y on 1, R and L over the counted pixels. The
//! residual is `β / β_input`, β_input being that of the unenhanced picture: 1 if the picture depends on the illumination like
//! the input, 0 if the picture no longer depends on it, negative if it is overcompensated.
//!
//! By the theorem of Frisch, Waugh and Lovell `β = Σ l y / Σ l²`, where l is the part of L that 1 and R do not explain,
//! so the residual is `Σ l y / Σ l y_input`.

mod low_pass;
mod residual;

pub use residual::{Illumination, TrueLight};
