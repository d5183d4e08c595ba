//! Image formation in water: attenuation, forward scatter, style blend, haze, presets and the plan.
//!
//! All light is linear; planes are row-major; per-meter quantities are in 1/m, arrays in the order red, green, blue. The
//! order of the stages is physics and therefore plain calls: [`chain::water`], then [`style_blend`], then [`haze`].

pub mod attenuation;
pub mod chain;
pub mod daylight;
pub mod lamp;
mod look;
mod math;
pub mod own_water;
mod particles;
pub mod plan;
mod scattering;
mod screen;
pub mod setting;
mod view;
mod waters;

pub use blend::style_blend;
pub use extremes::brightest;
pub use haze::haze;
use look::{blend, haze};
pub use math::legendre;
use math::{elementary, error_bound, extremes, polynomial};
pub use particles::{sediment, snow, turbidity};
pub use scattering::{forward_scatter, kernel, layering};
pub use screen::Screen;
use view::visibility;
pub use view::{eye, lit_point, range, visible_bounds};
pub use visibility::{LEAST_CONTRAST, Visibility, visibility};
pub use waters::{medium, preset, water};
