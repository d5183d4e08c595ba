//! A frame of the campaign: a description and its picture.

use std::sync::Arc;

use imaging::codec::{encode_npy_plane, encode_npy_rgb};
use imaging::{Plane, Rgb};
use renderer::{SceneBytes, SceneSource};
use serde_json::{Value, json};
use spec::{RangeFile, RangeKind};

use super::knobs::Knobs;

/// A frame of the campaign.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Case {
    /// The job of this one frame. It names an uploaded scene if there is a picture.
    pub(super) job: Value,
    /// The uploaded scene; `None` for a procedural one.
    pub(super) picture: Option<Picture>,
}

/// Radiance and range of an uploaded scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Picture {
    /// Linear light.
    pub(super) radiance: Rgb<f32>,
    /// Meters along the ray.
    pub(super) range: Plane<f32>,
}

impl Case {
    /// Completes a description: its scene if there is a picture, and its seed.
    pub(super) fn new(knobs: &Knobs, mut job: Value, picture: Option<Picture>) -> Self {
        if picture.is_some() {
            job["scene"]["kind"] = json!("uploaded");
            job["scene"]["id"] = json!("scn_00000000-0000-0000-0000-000000000000");
            // The picture defines the size.
            if let Some(camera) = job["camera"].as_object_mut() {
                camera.remove("width");
                camera.remove("height");
            }
        }
        job["metrics"] = json!([]);
        job["seed"] = json!(knobs.seed());
        Self { job, picture }
    }

    /// The scene data that the renderer needs in addition to the frame.
    pub(super) fn source(&self) -> SceneSource {
        let Some(picture) = &self.picture else {
            return SceneSource::Local;
        };
        SceneSource::Uploaded(Arc::new(SceneBytes {
            rgb: encode_npy_rgb(&picture.radiance),
            range: Some(RangeFile {
                file: encode_npy_plane(&picture.range),
                kind: RangeKind::Range,
                unit_m: None,
                invalid_code: None,
            }),
            instances: None,
            classes: None,
            world_from_camera: None,
            hfov_deg: None,
            scale: None,
            intrinsics: None,
        }))
    }

    /// Names and contents of the files that reproduce this frame with `fathom render` in the folder of the files, the job first.
    pub(super) fn files(&self, name: &str) -> Vec<(String, Vec<u8>)> {
        let mut job = self.job.clone();
        let mut files = Vec::new();
        if let Some(picture) = &self.picture {
            let (rgb, range) = (format!("{name}-rgb.npy"), format!("{name}-range.npy"));
            let lighting = job["scene"]["lighting"].take();
            job["scene"] = json!({
                "kind": "files", "rgb": rgb, "range": range
            });
            if !lighting.is_null() {
                job["scene"]["lighting"] = lighting;
            }
            files.push((rgb, encode_npy_rgb(&picture.radiance)));
            files.push((range, encode_npy_plane(&picture.range)));
        }
        files.insert(0, (format!("{name}.json"), job.to_string().into_bytes()));
        files
    }

    fn has(&self, pointer: &str) -> bool {
        self.job.pointer(pointer).is_some_and(|value| !value.is_null())
    }

    /// The parts of the frame in one line.
    pub(super) fn about(&self) -> String {
        let mut words: Vec<String> = Vec::new();
        for (pointer, word) in [
            ("/scene/family", "procedural"),
            ("/water/turbidity", "patches"),
            ("/water/snow", "snow"),
            ("/water/sediment", "sediment"),
            ("/daylight/sun_elevation_deg", "sky"),
        ] {
            words.extend(self.has(pointer).then(|| word.to_owned()));
        }
        words.extend((!self.has("/water")).then(|| "air".to_owned()));
        let model = &self.job["water"]["optics"]["forward_scatter"]["model"];
        words.extend(model.as_str().map(str::to_owned));
        let lamps = self.job["lights"].as_array().map_or(0, Vec::len);
        words.extend((lamps > 0).then(|| format!("{lamps} lamps")));
        let plain = ["width", "height", "hfov_deg", "up", "bits"];
        let camera = self.job["camera"].as_object().into_iter().flatten();
        for (part, value) in camera.filter(|(part, _)| !plain.contains(&part.as_str())) {
            words.push(match part.as_str() {
                "exposure" | "supersample" => format!("{part} {value}"),
                _ => part.clone(),
            });
        }
        words.push(match &self.picture {
            Some(picture) => format!("{}x{}", picture.range.width(), picture.range.height()),
            None => format!("{}x{}", self.job["camera"]["width"], self.job["camera"]["height"]),
        });
        words.join(", ")
    }
}
