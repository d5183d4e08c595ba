//! One frame, fully resolved: plain values, no law, no default left open.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::artifact::ArtifactKind;

/// One image of a job, with every law replaced by its value.
///
/// `parameters` is the same description as canonical JSON (sorted keys, defaults filled in): it is what the record
/// stores and what the digest of a job covers.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Position in the job, `0..frames`.
    pub index: u64,
    /// The job's seed.
    pub seed: u64,
    /// The dataset the image will belong to.
    pub dataset: String,
    /// What the camera would see in air.
    pub scene: Scene,
    /// Size and field of view; of a user's picture only `hfov_deg` is used, if it came without intrinsics.
    pub camera: Camera,
    /// The water.
    pub water: Water,
    /// Style weight of Algorithm 1, 0..=1: the share of the styled image.
    pub alpha: f64,
    /// Haze lights in the order in which they are laid over the picture.
    pub lights: Vec<Haze>,
    /// Lamps in the water, in the order of the description.
    pub lamps: Vec<Lamp>,
    /// Enhancement methods to run on the result.
    pub enhance: Vec<String>,
    /// Metrics to measure, `name` or `name@profile`.
    pub metrics: Vec<String>,
    /// How exact the water must be.
    pub fidelity: Fidelity,
    /// What to store.
    pub artifacts: Vec<ArtifactKind>,
    /// How to store RGB-like artifacts.
    pub encode: Encode,
    /// The user's own labels: scalars, stored and queryable as `labels.<name>`.
    pub labels: BTreeMap<String, Value>,
    /// The canonical JSON of all of the above, without `index`.
    pub parameters: Value,
}

/// Where radiance and range come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Scene {
    /// Rendered from a seed.
    Procedural {
        /// Family name, such as `structure`.
        family: String,
        /// Seed of the scene, independent of the job's seed.
        seed: u64,
    },
    /// Uploaded before through the API.
    Uploaded {
        /// `scn_…`.
        id: String,
    },
    /// Files of this machine; only for rendering without a service.
    Files {
        /// Path of a PNG, JPEG, WebP or NPY picture.
        rgb: String,
        /// The range or z-depth file, if there is one.
        #[serde(default, flatten)]
        range: Option<RangeFile>,
    },
}

/// A range or z-depth file with its unit. Exactly one of `range` and `z_depth` is set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RangeFile {
    /// Path of a file with distances along the line of sight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<String>,
    /// Path of a file with distances along the optical axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_depth: Option<String>,
    /// Metres of one unit of the file. Required for integer files; 1 for float files unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit_m: Option<f64>,
    /// The code that means "no return". Required for integer files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub invalid_code: Option<u16>,
}

/// A pinhole camera with square pixels and the principal point in the middle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Columns, 1..=16384.
    pub width: usize,
    /// Rows, 1..=16384.
    pub height: usize,
    /// Horizontal field of view in degrees, above 0 and below 180.
    pub hfov_deg: f64,
    /// The way past a procedural scene; absent: its usual place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<Path>,
}

/// A frame's place on the way of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// Frames from start to end.
    pub frames: usize,
    /// Which of them this is.
    pub frame: usize,
    /// Where it begins; absent: the family's own path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Waypoint>,
    /// Where it ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<Waypoint>,
    /// Amplitude of the sway in metres.
    pub sway_m: f64,
    /// Amplitude of the turns in degrees.
    pub sway_deg: f64,
    /// Their period in frames.
    pub sway_frames: f64,
}

/// Where a camera is and what it looks at, in metres in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// The camera.
    pub position_m: [f64; 3],
    /// What it looks at.
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

/// The water of a frame: optics, what varies with the place, and the style.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Water {
    /// Optical properties; absent: no attenuation and no scatter.
    pub optics: Option<Optics>,
    /// Multiplies every per-metre quantity, never the range artifact.
    pub range_scale: f64,
    /// Vertical depth of the camera below the surface in metres.
    pub depth_m: Option<f64>,
    /// What ambient light does to the scene's radiance.
    pub ambient: Ambient,
    /// What a pixel without a valid range means.
    pub holes: HoleRule,
    /// Marine snow; absent: none.
    pub snow: Option<crate::suspended::Snow>,
    /// Patches of murkier water; absent: even water.
    pub turbidity: Option<crate::suspended::Turbidity>,
    /// Name of a style model.
    pub style: Option<String>,
    /// What of the model is run; absent: the network.
    pub style_tier: Option<StyleTier>,
}

/// What of a style model is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StyleTier {
    /// The network.
    Net,
    /// Its colour table.
    Lut,
    /// The table where its measured distance from the network is within the tolerance, else the network.
    Auto,
}

/// A preset, coefficients, or a preset with fields replaced; absent is unknown. Arrays are R, G, B, coefficients in 1/m.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Optics {
    /// Preset name, such as `jerlov-3C` or `jerlov-3C/williamson2022` or `uuv-simulator`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// What the coefficients are called, such as a water of the user's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// c = a + b.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam_attenuation_per_m: Option<[f64; 3]>,
    /// a.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption_per_m: Option<[f64; 3]>,
    /// b.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scattering_per_m: Option<[f64; 3]>,
    /// Backscatter attenuation of the revised model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_attenuation_per_m: Option<[f64; 3]>,
    /// K_d, the decay of daylight with depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse_attenuation_per_m: Option<[f64; 3]>,
    /// Backscatter radiance at infinite range, linear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veiling_light: Option<[f64; 3]>,
    /// Brightness of a derived veiling light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veil_gain: Option<f64>,
    /// b_b/b, the share of the scattered light that goes backwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_fraction: Option<f64>,
    /// Forward scatter; absent: `jaffe` if absorption and scattering are known, else none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forward_scatter: Option<ForwardScatter>,
}

/// Forward scatter of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForwardScatter {
    /// Which form.
    pub model: ForwardScatterModel,
    /// G of the `jaffe` form, 1/m; absent: derived from absorption and scattering.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g_per_m: Option<[f64; 3]>,
    /// k of gamma(Z) = gamma_0 + k Z, pixels per metre; absent: derived from scattering and focal length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread_px_per_m: Option<[f64; 3]>,
    /// gamma_0, pixels; absent: 0 with a given spread, derived with a derived one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread_offset_px: Option<[f64; 3]>,
    /// What light the `jaffe` form spreads.
    #[serde(default)]
    pub source: ScatterSource,
}

/// The two published forms of forward scatter, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForwardScatterModel {
    /// Each source point spreads with its own range (Eq. 3-6 as meant).
    Jaffe,
    /// Each image point gathers with its own range (Eq. 8-9).
    Simplified,
    /// No forward scatter.
    None,
}

/// What light the `jaffe` form spreads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScatterSource {
    /// U = J w.
    #[default]
    Radiance,
    /// U = D w, the literal Eq. 3.
    Direct,
}

/// What ambient light does to the scene's radiance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ambient {
    /// The picture is what the camera would see in air, already lit.
    #[default]
    None,
    /// Radiance and a given veiling light are multiplied by exp(-K_d depth).
    Absolute,
    /// Radiance is multiplied by exp(-K_d depth) over its largest channel.
    Exposed,
}

/// What a pixel without a valid range means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HoleRule {
    /// The ray meets only water.
    #[default]
    Background,
    /// The range is this many metres.
    RangeM(f64),
    /// The frame is refused.
    Reject,
}

/// A light's haze, the paper's Gaussian overlay.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Haze {
    /// Position in fractions of the width; may lie outside 0..=1.
    pub x: f64,
    /// Position in fractions of the height; may lie outside 0..=1.
    pub y: f64,
    /// Sigma in image heights; 0 or less: the light is skipped.
    pub size: f64,
    /// 0..=1.
    pub intensity: f64,
    /// Colour in the working space; may exceed 1.
    pub color: [f64; 3],
    /// How it is laid over the picture.
    pub blend: HazeBlend,
    /// The space it is laid in; the same for all lights of a frame.
    pub space: HazeSpace,
}

/// A lamp in the water. The camera looks along z; x is right and y is down.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Lamp {
    /// Where it hangs, in metres from the camera.
    pub position_m: [f64; 3],
    /// Linear radiance times m², per steradian.
    pub intensity: [f64; 3],
    /// The beam of a spot; a point lamp has none.
    #[serde(default, flatten)]
    pub beam: Option<Beam>,
}

/// The beam of a spot lamp.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Beam {
    /// The axis, of any length but 0.
    pub direction: [f64; 3],
    /// Degrees from the axis at which no light is left.
    pub cone_deg: f64,
}

/// How haze is laid over the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HazeBlend {
    /// I (1 - alpha_l) + colour alpha_l.
    #[default]
    Over,
    /// I + colour alpha_l.
    Add,
}

/// The space haze is laid in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HazeSpace {
    /// Linear light.
    #[default]
    Linear,
    /// sRGB-encoded values, clamped to 0..=1, for likeness to the published pictures.
    Display,
}

/// How exact the water must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fidelity {
    /// Largest error in linear light.
    Tolerance(f64),
    /// One code of the 8-bit picture.
    Display,
    /// This many kernels in the fast forward scatter.
    Terms(usize),
    /// The slow f64 reference.
    Reference,
}

/// How RGB-like artifacts are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Encode {
    /// File format.
    pub format: Format,
    /// JPEG quality, 1..=100; only for `jpeg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<u8>,
}

/// File format of RGB-like artifacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// PNG, lossless.
    Png,
    /// WebP, lossless.
    Webp,
    /// JPEG.
    Jpeg,
}
