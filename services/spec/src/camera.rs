//! The camera of a frame, and its way past a procedural scene.

use serde::{Deserialize, Serialize};

/// A pinhole camera with square pixels and the principal point in the middle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// columns; at most 64 000 000 pixels in all
    pub width: usize,
    /// rows
    pub height: usize,
    /// horizontal field of view
    pub hfov_deg: f64,
    /// a way past a procedural scene; absent: its usual place
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Path>,
}

/// A frame's place on the way of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// frames from start to end
    pub frames: usize,
    /// place on the path; absent: each frame of the job in turn
    pub frame: usize,
    /// where it begins; with `end`; absent: the family's own path
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<Waypoint>,
    /// where it ends
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<Waypoint>,
    /// amplitude of the vehicle's sway
    pub sway_m: f64,
    /// amplitude of its turns
    pub sway_deg: f64,
    /// period of both, in frames
    pub sway_frames: f64,
}

/// Where a camera is and what it looks at, in metres in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// in the world: x, y, and z upwards
    pub position_m: [f64; 3],
    /// what the camera looks at
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
