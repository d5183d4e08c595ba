//! What stands between the water and the sensor: the port and the lens.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// Distortion of a lens after Brown and Conrady, from ideal to distorted coordinates.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Distortion {
    /// radial, of r²; below 0: barrel
    #[field(within(-1.0, 1.0), default = 0)]
    pub k1: f64,
    /// radial, of r⁴
    #[field(within(-1.0, 1.0), default = 0)]
    pub k2: f64,
    /// radial, of r⁶
    #[field(within(-1.0, 1.0), default = 0)]
    pub k3: f64,
    /// tangential
    #[field(within(-0.1, 0.1), default = 0)]
    pub p1: f64,
    /// tangential
    #[field(within(-0.1, 0.1), default = 0)]
    pub p2: f64,
}

/// The window of the housing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Port {
    /// None: the lens looks at the scene without refraction.
    None {},
    /// A flat window: refraction narrows the view and stretches it towards the corners.
    Flat {
        /// from the entrance pupil to the glass
        #[field(within(0.0, 0.2), default = 0, unit = "m")]
        pupil_m: f64,
        /// thickness of the glass
        #[field(within(0.0, 0.2), default = 0, unit = "m")]
        glass_m: f64,
    },
    /// A dome about the entrance pupil: directions stay, only focus changes.
    Dome {
        /// radius of the dome
        #[field(within(0.02, 1.0), default = 0.1, unit = "m")]
        radius_m: f64,
    },
}

/// Blur of what is out of focus.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Defocus {
    /// diameter of the aperture: focal length over f-number
    #[field(within(0.0, 0.1), unit = "m")]
    pub aperture_m: f64,
    /// range in the water that is sharp
    #[field(within(0.05, 1000.0), unit = "m")]
    pub focus_m: f64,
}

/// Movement of an uploaded picture while the shutter is open.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// columns that it moves
    #[field(within(-64.0, 64.0), default = 0, unit = "px")]
    pub x_px: f64,
    /// rows that it moves
    #[field(within(-64.0, 64.0), default = 0, unit = "px")]
    pub y_px: f64,
}

/// Light that falls off towards the corners.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Vignette {
    /// weight of the cosine to the fourth
    #[field(within(0.0, 1.0), default = 1)]
    pub v: f64,
    /// of q², the fourth power of the radius over that of the farthest corner
    #[field(within(-1.0, 1.0), default = 0)]
    pub v2: f64,
}
