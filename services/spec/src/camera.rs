//! The camera of a frame, and its way past a procedural scene.

mod lens;
mod sensor;

use serde::{Deserialize, Serialize};
use spec_derive::Described;

pub use lens::{Defocus, Distortion, Motion, Port, Vignette};
pub use sensor::{Cfa, Chroma, Exposure, Jpeg, Metering, Sensor, Tone, WhiteBalance};

/// A camera with square pixels and the principal point in the middle: a pinhole, and of a real one what is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// columns; at most 64 000 000 pixels in all
    #[field(within(1, 16_384), default = 768, unit = "px", needs("scene.family"))]
    pub width: usize,
    /// rows
    #[field(within(1, 16_384), default = 492, unit = "px", needs("scene.family"))]
    pub height: usize,
    /// horizontal field of view
    #[field(within(1.0, 170.0), default = 80, unit = "degree")]
    pub hfov_deg: f64,
    /// a way past a procedural scene; without one the camera stays at its usual place
    #[field(needs_always("scene.family"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Path>,
    /// where a camera without waypoints is and looks; drawn from the seed of the scene by default
    #[field(needs("scene.family"), excludes("camera.path.start"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<CameraView>,
    /// against gravity: right, down and ahead of a picture's camera; [0, -1, 0], a level camera, by default
    #[field(vector, within(-1000.0, 1000.0), nonzero, needs("scene.id", "scene.rgb"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// a camera whose parts the fields below replace; a pinhole without noise by default
    #[field(names = Camera, untraced = "a pinhole camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// frames of the path in a second, for exposure and readout
    #[field(within(0.1, 1000.0), default = 25, unit = "1/s", needs("path"))]
    pub frames_per_s: f64,
    /// how long the shutter is open: blur of movement along the path, dark current, streaks of drifting snow; by default 0.01 without
    /// blur
    #[field(within(1e-5, 1.0), unit = "s", untraced = "a still camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_s: Option<f64>,
    /// time from the first row to the last of a rolling shutter; all rows at once by default
    #[field(
        within(0.0, 0.2),
        unit = "s",
        needs("path"),
        untraced = "all rows are traced at once"
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub readout_s: Option<f64>,
    /// distortion of the lens; none by default
    #[field(untraced = "a pinhole camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distortion: Option<Distortion>,
    /// window of the housing; none by default
    #[field(untraced = "a pinhole camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<Port>,
    /// pixels of the scene for each of the picture, along a side
    #[field(
        within(1, 3),
        default = 1,
        needs_always("scene.family"),
        untraced = "one ray is traced for each pixel"
    )]
    pub supersample: usize,
    /// blur out of focus; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub defocus: Option<Defocus>,
    /// movement of an uploaded picture while the shutter is open; none by default
    #[field(needs("scene.id", "scene.rgb"), untraced = "a still camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
    /// light lost towards the corners; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vignette: Option<Vignette>,
    /// brightness; by default metered where lamps are the only light of a scene of reflectance, else a factor of 1
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<Exposure>,
    /// sensor with its noise; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<Sensor>,
    /// white balance; `off` by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_balance: Option<WhiteBalance>,
    /// curve from light to codes
    #[field(default = "srgb")]
    pub tone: Tone,
    /// bits of the picture's codes, 8 or 16
    #[field(within(8, 16), default = 8)]
    pub bits: u8,
    /// JPEG compression of the picture; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jpeg: Option<Jpeg>,
}

/// The view of a procedural scene. The camera looks at or past what the family shows; values that are not given are drawn from the
/// scene's seed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct CameraView {
    /// elevation of the line of sight, negative looks down; drawn from -30 to 40 unless given, nearer to the family's own where nothing would be in view
    #[field(within(-85.0, 85.0), unit = "degree")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_deg: Option<f64>,
    /// azimuth of the line of sight: 0 looks along y at the front of the site, 90 along x; drawn about the family's own unless given
    #[field(within(-180.0, 180.0), unit = "degree")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yaw_deg: Option<f64>,
    /// height of the camera above the bottom, in open water above a level 6 m below the middle of the site; drawn from the family's range unless given
    #[field(within(0.05, 60.0), unit = "m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// distance along the line of sight to the vertical through the target; drawn from the family's range unless given
    #[field(within(0.05, 50.0), unit = "m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

/// A frame's place on the way of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// frames from start to end
    #[field(fixed, within(1, 1_000_000))]
    pub frames: usize,
    /// position on the path; each frame of the job in turn by default
    #[field(fixed, within(0, 999_999), optional, below("frames"))]
    pub frame: usize,
    /// where it begins; on the family's own path by default
    #[field(needs("end"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<Waypoint>,
    /// where it ends
    #[field(needs("start"), differs("start"))]
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
            view: None,
            up: None,
            preset: None,
            frames_per_s: 25.0,
            exposure_s: None,
            readout_s: None,
            distortion: None,
            port: None,
            supersample: 1,
            defocus: None,
            motion: None,
            vignette: None,
            exposure: None,
            sensor: None,
            white_balance: None,
            tone: Tone::Srgb,
            bits: 8,
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
            view: self.view,
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
