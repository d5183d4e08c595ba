//! The part of a picture that an enhancement keeps.

use serde::Deserialize;
use spec_derive::Described;

use super::mask_image::MaskImage;

/// The kept part of a picture.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Mask {
    /// The whole picture.
    #[default]
    None,
    /// The circle of the published method, made for one vehicle.
    Paper,
    /// a circle
    Circle(Circle),
    /// everything but saturated pixels and their surroundings
    Saturated(Saturated),
    /// a PNG of the picture's size in base64: black pixels are removed
    #[field(names = MaskImage)]
    Image(MaskImage),
}

/// A circle relative to the picture; it may be outside.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[described(name = "MaskCircle")]
pub struct Circle {
    /// column of the center in picture widths
    #[field(within(-10.0, 10.0), default = 0.5)]
    pub center_x: f64,
    /// row of the center in picture heights
    #[field(within(-10.0, 10.0), default = 0.5)]
    pub center_y: f64,
    /// radius in picture widths
    #[field(within(0.0, 10.0), default = 0.5)]
    pub radius: f64,
}

/// Saturated pixels of the picture before the enhancement.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
#[described(name = "MaskSaturated")]
pub struct Saturated {
    /// least saturated code of any channel, 8 bit
    #[field(within(1, 255), default = 250)]
    pub threshold: u8,
    /// radius of the removed square around each saturated pixel
    #[field(within(0, 200), default = 5, unit = "px")]
    pub dilation_px: usize,
}

impl Circle {
    /// The circle of the published method.
    pub const PAPER: Self = Self {
        center_x: 0.45,
        center_y: 0.33,
        radius: 0.44,
    };
}
