//! The part of a frame that has a Monte Carlo truth.

use serde_json::{Value, json};
use spec::{Camera, Exposure, Frame, HoleRule, Light, Metering, Scene};

use crate::error::RenderError;

/// Fields of a camera that both sides of the comparison have. The frame rate only matters for an open shutter.
const KEPT_OF_CAMERA: [&str; 8] = [
    "width",
    "height",
    "hfov_deg",
    "path",
    "view",
    "up",
    "exposure",
    "frames_per_s",
];
/// Fields of a camera without an effect at these values, which are their defaults.
fn unused_of_camera() -> Value {
    json!({"supersample": 1, "tone": "srgb", "bits": 8})
}

/// A frame as the truth can show it, and the fields of its description that the comparison leaves out.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparableFrame {
    /// The frame with a pinhole and its exposure, without snow, sediment, style and haze.
    pub frame: Frame,
    /// Fields on neither side of the comparison, such as `water.snow`.
    pub left_out: Vec<String>,
}

impl ComparableFrame {
    /// Reduces a frame with a procedural scene to this size and to the light with a truth.
    ///
    /// # Errors
    /// The scene has files, whose size is fixed.
    pub fn new(frame: &Frame, (width, height): (usize, usize)) -> Result<Self, RenderError> {
        if !matches!(frame.scene, Scene::Procedural { .. }) {
            return Err(RenderError::FixedSize);
        }
        let mut left_out = list_left_out(&frame.parameters);
        let mut reduced = Frame {
            camera: Camera {
                path: frame.camera.path,
                view: frame.camera.view,
                up: frame.camera.up,
                exposure: exposure(frame),
                ..Camera::pinhole(width, height, frame.camera.hfov_deg)
            },
            artifacts: Vec::new(),
            metrics: Vec::new(),
            ..frame.clone()
        };
        reduced.lights.retain(|light| !matches!(light, Light::Haze(_)));
        reduced.enhance.clear();
        reduced.water.snow = None;
        reduced.water.sediment = None;
        reduced.water.style = None;
        if matches!(reduced.water.holes, HoleRule::RangeM(_)) {
            reduced.water.holes = HoleRule::Background;
            left_out.push("water.holes".to_owned());
        }
        Ok(Self {
            frame: reduced,
            left_out,
        })
    }
}

/// The exposure of a frame's camera; that of a sequence without its lag, which depends on earlier frames.
fn exposure(frame: &Frame) -> Option<Exposure> {
    let exposure = ::camera::preset::complete(&frame.camera).exposure;
    exposure.map(|exposure| match exposure {
        Exposure::Auto(metering) => Exposure::Auto(Metering {
            lag_frames: 0.0,
            ..metering
        }),
        Exposure::Fixed(gain) => Exposure::Fixed(gain),
    })
}

/// The fields of a resolved description that are on neither side of a comparison, in the order of light.
fn list_left_out(parameters: &Value) -> Vec<String> {
    let water = ["sediment", "snow", "style"].into_iter();
    let water = water.filter(|name| !parameters["water"][name].is_null());
    let mut left_out: Vec<String> = water.map(|name| format!("water.{name}")).collect();
    let lights = parameters["lights"].as_array().into_iter().flatten();
    if lights.into_iter().any(|light| light["kind"] == "haze") {
        left_out.push("lights (haze)".to_owned());
    }
    let unused = unused_of_camera();
    let camera = parameters["camera"].as_object().into_iter().flatten();
    let camera = camera.filter(|(name, value)| {
        let is_kept = KEPT_OF_CAMERA.contains(&name.as_str());
        !is_kept && !value.is_null() && unused[name.as_str()] != **value
    });
    left_out.extend(camera.map(|(name, _)| format!("camera.{name}")));
    left_out
}
