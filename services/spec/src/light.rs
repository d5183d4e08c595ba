//! The lights of a frame: lamps in the water, and the paper's haze.

use serde::Deserialize;
use spec_derive::Described;

/// A light.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Light {
    /// An overlay, no physics.
    Haze(Haze),
    /// A lamp that shines in all directions.
    Point(PointLamp),
    /// A lamp that shines about an axis.
    Spot(SpotLamp),
}

/// A Gaussian laid over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Haze {
    /// position in image widths
    #[field(within(-100.0, 100.0))]
    pub x: f64,
    /// position in image heights
    #[field(within(-100.0, 100.0))]
    pub y: f64,
    /// sigma in image heights; 0 or less: skipped
    #[field(finite, default = 0.2)]
    pub size: f64,
    /// weight at the center
    #[field(within(0.0, 1.0), default = 1)]
    pub intensity: f64,
    /// color in the space of the haze
    #[field(within(0.0, 1000.0), default = [1, 1, 1])]
    pub color: [f64; 3],
    /// how it is laid over the picture
    #[field(default = "over")]
    pub blend: HazeBlend,
    /// the same for all haze
    #[field(fixed, default = "linear")]
    pub space: HazeSpace,
}

impl Haze {
    /// Whether it does anything at all.
    #[must_use]
    pub fn shines(&self) -> bool {
        self.size > 0.0 && self.size.is_finite() && self.intensity > 0.0
    }
}

/// How haze is laid over the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum HazeBlend {
    /// Covers what is below: I (1 − α) + color α.
    #[default]
    Over,
    /// Adds to what is below: I + color α.
    Add,
}

/// The space haze is laid in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum HazeSpace {
    /// Linear light.
    #[default]
    Linear,
    /// sRGB-encoded values, clamped to 0..=1, for likeness to the published pictures.
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
    /// radius of the sphere that shines: the larger, the softer its shadows
    #[field(within(0.0, 0.5), unit = "m", default = 0.02)]
    pub radius_m: f64,
}

/// A lamp that shines about an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
pub struct SpotLamp {
    /// meters right, down and ahead of the camera
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub position_m: [f64; 3],
    /// linear radiance times m², per steradian; of a spot along its axis
    #[field(within(0.0, 1e6))]
    pub intensity: [f64; 3],
    /// axis
    #[field(vector, within(-1000.0, 1000.0), default = [0, 0, 1], nonzero)]
    pub direction: [f64; 3],
    /// angle from the axis at which no light is left
    #[field(within(0.5, 90.0), default = 30, unit = "degree")]
    pub cone_deg: f64,
    /// radius of the sphere that shines: the larger, the softer its shadows
    #[field(within(0.0, 0.5), unit = "m", default = 0.02)]
    pub radius_m: f64,
}

/// Where shadow rays look for occluders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RaySource {
    /// The solids of a procedural scene.
    Scene,
    /// The range image: only what the picture shows occludes.
    Screen,
}
