//! The camera of a frame, and its path through a procedural scene.

mod lens;
mod sensor;

use serde::{Deserialize, Serialize};
use spec_derive::Described;

pub use lens::{Defocus, Distortion, Motion, Port, Vignette};
pub use sensor::{Cfa, Chroma, Exposure, Jpeg, Metering, Sensor, Tone, WhiteBalance};

/// A camera with square pixels and a centered principal point: a pinhole, plus the given parts of a real camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// image columns; at most 64 000 000 pixels in all
    #[field(within(1, 16_384), default = 768, unit = "px", needs("scene.family"))]
    pub width: usize,
    /// image rows
    #[field(within(1, 16_384), default = 492, unit = "px", needs("scene.family"))]
    pub height: usize,
    /// horizontal field of view
    #[field(within(1.0, 170.0), default = 80, unit = "degree")]
    pub hfov_deg: f64,
    /// camera path through a procedural scene; stays at the scene's usual viewpoint by default
    #[field(needs_always("scene.family"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Path>,
    /// viewpoint of a camera without waypoints; drawn from the seed of the scene by default
    #[field(needs("scene.family"), excludes("camera.path.start"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<CameraView>,
    /// direction opposite to gravity in camera axes: right, down, ahead; [0, -1, 0], a level camera, by default
    #[field(vector, within(-1000.0, 1000.0), nonzero, needs("scene.id", "scene.rgb"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// second camera on the right; none by default
    #[field(
        needs_always("scene.family"),
        needs("artifacts.rgb_right", "artifacts.disparity")
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stereo: Option<Stereo>,
    /// camera preset whose fields the others replace; a noise-free pinhole by default
    #[field(names = Camera, untraced = "a pinhole camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// frame rate of the path, for exposure and readout
    #[field(within(0.1, 1000.0), default = 25, unit = "1/s", needs("path"))]
    pub frames_per_s: f64,
    /// time the shutter is open, for motion blur, dark current and snow streaks; 0.01 without blur by default
    #[field(within(1e-5, 1.0), unit = "s", untraced = "a still camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_s: Option<f64>,
    /// readout time of a rolling shutter from first to last row; global shutter by default
    #[field(
        within(0.0, 0.2),
        unit = "s",
        needs("path"),
        untraced = "all rows are traced at once"
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub readout_s: Option<f64>,
    /// lens distortion; none by default
    #[field(untraced = "a pinhole camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distortion: Option<Distortion>,
    /// window of the housing; none by default
    #[field(untraced = "a pinhole camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<Port>,
    /// rendered samples per image pixel, along a side
    #[field(
        within(1, 3),
        default = 1,
        needs_always("scene.family"),
        untraced = "one ray is traced for each pixel"
    )]
    pub supersample: usize,
    /// defocus blur; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub defocus: Option<Defocus>,
    /// motion of an uploaded image while the shutter is open; none by default
    #[field(needs("scene.id", "scene.rgb"), untraced = "a still camera is traced")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
    /// light falloff towards the corners; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vignette: Option<Vignette>,
    /// brightness; metered by default if lamps are the only light of a reflectance scene, else a factor of 1
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<Exposure>,
    /// sensor and its noise; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<Sensor>,
    /// white balance; `off` by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_balance: Option<WhiteBalance>,
    /// tone curve from light to codes
    #[field(default = "srgb")]
    pub tone: Tone,
    /// bit depth of the image, 8 or 16
    #[field(within(8, 16), default = 8)]
    pub bits: u8,
    /// JPEG compression of the image; none by default
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jpeg: Option<Jpeg>,
}

/// A stereo pair of equal cameras with parallel axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Stereo {
    /// distance of the right camera, along the x axis of the left one
    #[field(above(0.0, 10.0), unit = "m")]
    pub baseline_m: f64,
}

/// The viewpoint in a procedural scene. Absent values are drawn from the scene's seed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct CameraView {
    /// elevation of the line of sight, negative is down; drawn from -30 to 40 unless given, closer to the family's
    /// usual pitch to keep the target in view
    #[field(within(-85.0, 85.0), unit = "degree")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_deg: Option<f64>,
    /// azimuth of the line of sight: 0 looks along y at the front of the site, 90 along x; drawn around the family's
    /// usual yaw unless given
    #[field(within(-180.0, 180.0), unit = "degree")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yaw_deg: Option<f64>,
    /// camera height above the bottom, in open water above a plane 6 m below the middle of the site; drawn from the
    /// family's range unless given
    #[field(within(0.05, 60.0), unit = "m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// distance along the line of sight to the vertical through the target; drawn from the family's range unless
    /// given
    #[field(within(0.05, 50.0), unit = "m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

/// Position of a frame on a camera path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// frames from start to end
    #[field(fixed, within(1, 1_000_000))]
    pub frames: usize,
    /// position on the path; advances with each frame of the job by default
    #[field(fixed, within(0, 999_999), optional, below("frames"))]
    #[serde(default)]
    pub frame: usize,
    /// first waypoint; on the family's usual path by default
    #[field(needs("end"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<Waypoint>,
    /// last waypoint
    #[field(needs("start"), differs("start"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<Waypoint>,
    /// amplitude of the vehicle's sway
    #[field(within(0.0, 1.0), default = 0, unit = "m")]
    pub sway_m: f64,
    /// amplitude of the vehicle's rotation
    #[field(within(0.0, 28.0), default = 0, unit = "degree")]
    pub sway_deg: f64,
    /// period of sway and rotation, frames
    #[field(within(2.0, 1e6), default = 40)]
    pub sway_frames: f64,
}

/// Camera position and target, meters in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// position in the world: x, y, and z upwards
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub position_m: [f64; 3],
    /// point in the center of the view
    #[field(vector, within(-1000.0, 1000.0), unit = "m")]
    pub target_m: [f64; 3],
}

impl Camera {
    /// A pinhole camera with this image size and horizontal field of view.
    #[must_use]
    pub fn pinhole(width: usize, height: usize, hfov_deg: f64) -> Self {
        Self {
            width,
            height,
            hfov_deg,
            path: None,
            view: None,
            up: None,
            stereo: None,
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

    /// The camera for this image size and focal length in pixels: the inverse of [`Camera::focal_px`].
    #[must_use]
    pub fn from_focal(width: usize, height: usize, focal_px: f64) -> Self {
        let half = libm::atan(width as f64 / 2.0 / focal_px);
        Self::pinhole(width, height, (2.0 * half).to_degrees())
    }

    /// Whether the camera is a noise-free pinhole, without any real-camera part.
    #[must_use]
    pub fn is_pinhole(&self) -> bool {
        let bare = Self {
            path: self.path,
            view: self.view,
            up: self.up,
            stereo: self.stereo,
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
