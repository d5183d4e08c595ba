//! Image formation in water: attenuation, forward scatter, style blend, haze, presets and the plan.

pub mod kernel;
pub mod preset;
pub mod range;
pub mod water;
