//! The camera of a frame, and its way past a procedural scene.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// A pinhole camera with square pixels and the principal point in the middle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
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
    /// The camera of a picture of this size and focal length in pixels: the inverse of [`Camera::focal_px`].
    #[must_use]
    pub fn of_picture(width: usize, height: usize, focal_px: f64) -> Self {
        let half = libm::atan(width as f64 / 2.0 / focal_px);
        Self {
            width,
            height,
            hfov_deg: (2.0 * half).to_degrees(),
            path: None,
        }
    }

    /// Focal length in pixels: `f = (W/2) / tan(hfov/2)`.
    #[must_use]
    pub fn focal_px(&self, width: usize) -> f64 {
        let half = libm::tan(self.hfov_deg.to_radians() / 2.0);
        width as f64 / 2.0 / half
    }
}
