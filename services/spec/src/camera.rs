//! The camera of a frame, and its way past a procedural scene.

mod lens;
mod sensor;

use serde::{Deserialize, Serialize};
use spec_derive::Described;

use crate::schema::EXACT;

pub use lens::{Defocus, Distortion, Motion, Port, Rolling, Vignette};
pub use sensor::{Cfa, Chroma, Exposure, Jpeg, Metering, Sensor, Tone, WhiteBalance};

/// A camera with square pixels and the principal point in the middle: a pinhole, and of a real one what is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// columns; at most 64 000 000 pixels in all
    #[field(within(1, 16_384), default = 768, unit = "px")]
    pub width: usize,
    /// rows
    #[field(within(1, 16_384), default = 492, unit = "px")]
    pub height: usize,
    /// horizontal field of view
    #[field(within(1.0, 170.0), default = 80, unit = "degree")]
    pub hfov_deg: f64,
    /// a way past a procedural scene; absent: its usual place
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Path>,
    /// against gravity: right, down and ahead of a picture's camera, of any length but 0; absent: [0, -1, 0], a level camera
    #[field(vector, within(-1000.0, 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// a camera whose parts the fields below replace; absent: a pinhole without noise
    #[field(names = Camera)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// seed of the sensor's pattern and noise; absent: the job's
    #[field(within(0, EXACT))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// frames of the path in a second, for exposure and readout; absent: 25
    #[field(within(0.1, 1000.0), unit = "1/s")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames_per_s: Option<f64>,
    /// distortion of the lens; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distortion: Option<Distortion>,
    /// window of the housing; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<Port>,
    /// pixels of the scene for each of the picture, along a side; absent: 1
    #[field(within(1, 3))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supersample: Option<usize>,
    /// blur out of focus; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub defocus: Option<Defocus>,
    /// blur of movement; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
    /// rolling shutter; absent: all rows at once
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rolling: Option<Rolling>,
    /// light lost towards the corners; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vignette: Option<Vignette>,
    /// brightness; by default metered where lamps are the only light of a scene of reflectance, else a factor of 1
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<Exposure>,
    /// sensor with its noise; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<Sensor>,
    /// white balance; absent: `off`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_balance: Option<WhiteBalance>,
    /// curve from light to codes; absent: `srgb`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tone: Option<Tone>,
    /// bits of the picture's codes, 8 or 16; absent: 8
    #[field(within(8, 16))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bits: Option<u8>,
    /// JPEG compression of the picture; absent: none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jpeg: Option<Jpeg>,
}

/// A frame's place on the way of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// frames from start to end
    #[field(fixed, within(1, 1_000_000))]
    pub frames: usize,
    /// place on the path; absent: each frame of the job in turn
    #[field(fixed, within(0, 999_999), optional)]
    pub frame: usize,
    /// where it begins; with `end`; absent: the family's own path
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<Waypoint>,
    /// where it ends
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<Waypoint>,
    /// amplitude of the vehicle's sway
    #[field(within(0.0, 1.0), default = 0, unit = "m")]
    pub sway_m: f64,
    /// amplitude of its turns
    #[field(within(0.0, 28.0), default = 0, unit = "degree")]
    pub sway_deg: f64,
    /// period of both, in frames
    #[field(within(2.0, 1e6), default = 40)]
    pub sway_frames: f64,
}

/// Where a camera is and what it looks at, in meters in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// in the world: x, y, and z upwards
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub position_m: [f64; 3],
    /// what the camera looks at
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub target_m: [f64; 3],
}

impl Camera {
    /// A pinhole camera of these sides and horizontal field of view.
    #[must_use]
    pub fn pinhole(width: usize, height: usize, hfov_deg: f64) -> Self {
        Self {
            width,
            height,
            hfov_deg,
            path: None,
            up: None,
            preset: None,
            seed: None,
            frames_per_s: None,
            distortion: None,
            port: None,
            supersample: None,
            defocus: None,
            motion: None,
            rolling: None,
            vignette: None,
            exposure: None,
            sensor: None,
            white_balance: None,
            tone: None,
            bits: None,
            jpeg: None,
        }
    }

    /// The camera of a picture of this size and focal length in pixels: the inverse of [`Camera::focal_px`].
    #[must_use]
    pub fn of_picture(width: usize, height: usize, focal_px: f64) -> Self {
        let half = libm::atan(width as f64 / 2.0 / focal_px);
        Self::pinhole(width, height, (2.0 * half).to_degrees())
    }

    /// Whether it is a pinhole without noise: no part of a real camera is given.
    #[must_use]
    pub fn is_pinhole(&self) -> bool {
        let bare = Self {
            path: self.path,
            up: self.up,
            ..Self::pinhole(self.width, self.height, self.hfov_deg)
        };
        *self == bare
    }

    /// Focal length in pixels: `f = (W/2) / tan(hfov/2)`.
    #[must_use]
    pub fn focal_px(&self, width: usize) -> f64 {
        let half = libm::tan(self.hfov_deg.to_radians() / 2.0);
        width as f64 / 2.0 / half
    }
}
