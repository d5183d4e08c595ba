//! The lights of a frame: lamps in the water, and the paper's haze.

use serde::Deserialize;
use spec_derive::Described;

/// A light.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Light {
    /// A non-physical overlay.
    Haze(Haze),
    /// A lamp that shines in all directions.
    Point(PointLamp),
    /// A lamp that shines around an axis.
    Spot(SpotLamp),
}

/// A Gaussian overlay on the image.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Haze {
    /// position in image widths
    #[field(within(-100.0, 100.0))]
    pub x: f64,
    /// position in image heights
    #[field(within(-100.0, 100.0))]
    pub y: f64,
    /// sigma in image heights; skipped if 0 or less
    #[field(finite, default = 0.2)]
    pub size: f64,
    /// weight at the center
    #[field(within(0.0, 1.0), default = 1)]
    pub intensity: f64,
    /// color in the space of the haze
    #[field(within(0.0, 1000.0), default = [1, 1, 1])]
    pub color: [f64; 3],
    /// blend mode
    #[field(default = "over")]
    pub blend: HazeBlend,
    /// color space; the same for all haze
    #[field(fixed, default = "linear")]
    pub space: HazeSpace,
}

impl Haze {
    /// Whether it has any effect.
    #[must_use]
    pub fn shines(&self) -> bool {
        self.size > 0.0 && self.size.is_finite() && self.intensity > 0.0
    }
}

/// Blend mode of haze.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum HazeBlend {
    /// Normal blending: I (1 − α) + color α.
    #[default]
    Over,
    /// Additive blending: I + color α.
    Add,
}

/// Color space of haze.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum HazeSpace {
    /// Linear light.
    #[default]
    Linear,
    /// sRGB-encoded values, clamped to 0..=1, to match the published images.
    Display,
}

/// A lamp that shines in all directions. The camera looks along z; x is right and y is down.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
pub struct PointLamp {
    /// meters right, down and ahead of the camera
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub position_m: [f64; 3],
    /// linear radiance times m², per steradian; of a spot along its axis
    #[field(within(0.0, 1e6))]
    pub intensity: [f64; 3],
    /// radius of the emitting sphere; larger means softer shadows
    #[field(within(0.0, 0.5), unit = "m", default = 0.02)]
    pub radius_m: f64,
}

/// A lamp that shines around an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
pub struct SpotLamp {
    /// meters right, down and ahead of the camera
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub position_m: [f64; 3],
    /// linear radiance times m², per steradian; of a spot along its axis
    #[field(within(0.0, 1e6))]
    pub intensity: [f64; 3],
    /// direction of the axis
    #[field(vector, within(-1000.0, 1000.0), default = [0, 0, 1], nonzero)]
    pub direction: [f64; 3],
    /// angle from the axis at which the light reaches zero
    #[field(within(0.5, 90.0), default = 30, unit = "degree")]
    pub cone_deg: f64,
    /// radius of the emitting sphere; larger means softer shadows
    #[field(within(0.0, 0.5), unit = "m", default = 0.02)]
    pub radius_m: f64,
}

/// Where shadow rays look for occluders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RaySource {
    /// The solids of a procedural scene.
    Scene,
    /// The range image: only visible surfaces occlude.
    Screen,
}
