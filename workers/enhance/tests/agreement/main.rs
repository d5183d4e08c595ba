//! Fast variants against reference variants: content × size × variant.

mod blocks;
mod content;
mod hscm;
mod methods;

pub(crate) use content::{SIZES, noise, pictures};
