//! Port and lens.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// Lens distortion after Brown and Conrady, from ideal to distorted coordinates.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Distortion {
    /// radial coefficient of r²; negative is barrel distortion
    #[field(within(-1.0, 1.0), default = 0)]
    pub k1: f64,
    /// radial coefficient of r⁴
    #[field(within(-1.0, 1.0), default = 0)]
    pub k2: f64,
    /// radial coefficient of r⁶
    #[field(within(-1.0, 1.0), default = 0)]
    pub k3: f64,
    /// tangential coefficient
    #[field(within(-0.1, 0.1), default = 0)]
    pub p1: f64,
    /// tangential coefficient
    #[field(within(-0.1, 0.1), default = 0)]
    pub p2: f64,
}

/// The window of the housing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Port {
    /// No port: rays are not refracted.
    None {},
    /// A flat window: refraction narrows the view and stretches it towards the corners.
    Flat {
        /// distance from the entrance pupil to the glass
        #[field(within(0.0, 0.2), default = 0, unit = "m")]
        pupil_m: f64,
        /// glass thickness
        #[field(within(0.0, 0.2), default = 0, unit = "m")]
        glass_m: f64,
    },
    /// A dome centered at the entrance pupil: only focus changes.
    Dome {
        /// dome radius
        #[field(within(0.02, 1.0), default = 0.1, unit = "m")]
        radius_m: f64,
    },
}

/// Defocus blur.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Defocus {
    /// aperture diameter: focal length over f-number
    #[field(within(0.0, 0.1), unit = "m")]
    pub aperture_m: f64,
    /// range in focus, in water
    #[field(within(0.05, 1000.0), unit = "m")]
    pub focus_m: f64,
}

/// Motion of an uploaded image while the shutter is open.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// motion, columns
    #[field(within(-64.0, 64.0), default = 0, unit = "px")]
    pub x_px: f64,
    /// motion, rows
    #[field(within(-64.0, 64.0), default = 0, unit = "px")]
    pub y_px: f64,
}

/// Light falloff towards the corners.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Vignette {
    /// weight of the cosine to the fourth
    #[field(within(0.0, 1.0), default = 1)]
    pub v: f64,
    /// weight of q², the fourth power of the radius relative to the farthest corner
    #[field(within(-1.0, 1.0), default = 0)]
    pub v2: f64,
}
