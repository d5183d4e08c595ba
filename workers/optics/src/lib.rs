//! Image formation in water: attenuation, forward scatter, style blend, haze, presets and the plan.
//!
//! All light is linear; planes are row-major; per-meter quantities are in 1/m, arrays in the order red, green, blue. The
//! order of the stages is physics and therefore plain calls: [`chain::water`], then [`style_blend`], then [`haze`].

pub mod attenuation;
mod blend;
pub mod chain;
pub mod daylight;
mod elementary;
mod error_bound;
mod extremes;
pub mod eye;
pub mod forward_scatter;
mod haze;
pub mod kernel;
pub mod lamp;
pub mod layering;
pub mod legendre;
pub mod medium;
pub mod own_water;
pub mod plan;
mod polynomial;
pub mod preset;
pub mod range;
mod screen;
pub mod sediment;
pub mod setting;
pub mod snow;
pub mod turbidity;
mod visibility;
pub mod visible_bounds;
pub mod water;

pub use blend::style_blend;
pub use extremes::brightest;
pub use haze::haze;
pub use screen::Screen;
pub use visibility::{LEAST_CONTRAST, Visibility, visibility};
