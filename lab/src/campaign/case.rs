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
            for (field, value) in [("kind", "files"), ("rgb", &rgb), ("range", &range)] {
                job["scene"][field] = json!(value);
            }
            job["scene"].as_object_mut().map(|scene| scene.remove("id"));
            files.push((rgb, encode_npy_rgb(&picture.radiance)));
            files.push((range, encode_npy_plane(&picture.range)));
        }
        files.insert(0, (format!("{name}.json"), job.to_string().into_bytes()));
        files
    }
}
