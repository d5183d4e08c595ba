//! What must fit together within the camera, and with the scene before it.

use std::collections::BTreeSet;

use imaging::codec::MAX_PIXELS;
use serde::Deserialize;

use super::Checker;
use super::extremes::each_draw;
use super::places::places;
use crate::camera::Camera;
use crate::invalid::FieldError;
use crate::node::{Drawn, LawNode, Node};

/// Parts of a camera that rules of their own hold together.
const PARTS: [&str; 7] = [
    "preset",
    "distortion",
    "port",
    "supersample",
    "sensor",
    "rolling",
    "bits",
];

impl Checker<'_> {
    /// Tries the camera at the extremes of its laws and of the first of `frames` frames. Says nothing about a camera that has
    /// errors already.
    pub(crate) fn cameras(&mut self, document: &Node, frames: u64) {
        let Some(camera) = document.get("camera") else {
            return;
        };
        let alternatives = camera.alternatives("");
        let has = |name: &&str| alternatives.iter().any(|(_, camera)| camera.get(name).is_some());
        let is_wrong = self
            .errors
            .iter()
            .any(|error| error.pointer.starts_with("/camera"));
        if is_wrong || !PARTS.iter().any(has) {
            return;
        }
        let scenes = places(document, "scene");
        let renders = |(_, scene): &(String, &Node)| scene.get("family").is_some();
        let kinds: BTreeSet<bool> = scenes.iter().map(renders).collect();
        let mut found = BTreeSet::new();
        each_draw(camera, frames, &mut |draw| {
            for &renders in &kinds {
                self.try_camera(camera, renders, &draw, &mut found);
            }
        });
    }

    /// Adds the errors of one camera; of each place only the first.
    fn try_camera(
        &mut self,
        camera: &Node,
        renders: bool,
        draw: &impl Fn(&LawNode) -> Drawn,
        found: &mut BTreeSet<String>,
    ) {
        let Ok(values) = Camera::deserialize(camera.value(draw)) else {
            return;
        };
        for fault in (self.vocabulary.camera_rules.faults)(&values, renders) {
            let pointer = camera.locate("/camera", &fault.path, draw);
            if found.insert(pointer.clone()) {
                let varied = if camera.laws().is_empty() {
                    ""
                } else {
                    "a camera that the distributions can yield: "
                };
                self.refuse(|| FieldError::new(&pointer, format!("{varied}{}", fault.message)));
            }
        }
    }

    /// The size of the picture, and a file for its codes.
    pub(super) fn camera(&mut self, document: &Node) {
        let is_png = |(_, encode): &(String, &Node)| {
            let format = encode.get("format").map(|format| format.strings(""));
            format.into_iter().flatten().all(|(_, name)| name == "png")
        };
        let all_png = places(document, "encode").iter().all(is_png);
        for (pointer, camera) in places(document, "camera") {
            let greatest = |name| camera.get(name).and_then(Node::greatest).unwrap_or_default();
            let (width, height) = (greatest("width"), greatest("height"));
            if width * height > MAX_PIXELS as f64 {
                let message =
                    format!("`camera` can be {width}×{height} pixels, the limit is {MAX_PIXELS} pixels");
                self.refuse(|| FieldError::new(&pointer, message).limit(format!("{MAX_PIXELS} pixels")));
            }
            if greatest("bits") > 8.0 && !all_png {
                let message = format!(
                    "`camera.bits` is {}, but only PNG holds more than 8: set `encode.format` to \"png\"",
                    greatest("bits")
                );
                self.refuse(|| FieldError::new(&format!("{pointer}/bits"), message));
            }
        }
    }
}
