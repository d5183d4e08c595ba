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
                    "a camera that the laws can yield: "
                };
                self.refuse(|| FieldError::new(&pointer, format!("{varied}{}", fault.message)));
            }
        }
    }

    /// A view needs a scene that is rendered, and no waypoints in its place.
    fn views(&mut self, document: &Node) {
        let scenes = places(document, "scene");
        let renders = scenes.iter().any(|(_, scene)| scene.get("family").is_some());
        for (pointer, camera) in places(document, "camera") {
            if camera.get("view").is_none() {
                continue;
            }
            let paths = camera.get("path").map(|path| path.alternatives(""));
            let has_waypoints = paths
                .into_iter()
                .flatten()
                .any(|(_, path)| path.get("start").is_some());
            let message = if !renders {
                "`camera.view` needs a procedural scene: a picture has the view it was taken from"
            } else if has_waypoints {
                "`camera.view` is given together with `start` of `camera.path`; leave one of them out"
            } else {
                continue;
            };
            self.refuse(|| FieldError::new(&format!("{pointer}/view"), message));
        }
    }

    /// Checks the size of the picture, and that what moves has a way to move.
    pub(super) fn camera(&mut self, document: &Node) {
        let scenes = places(document, "scene");
        let is_rendered = |scene: &Node| scene.get("family").is_some();
        let all_rendered = scenes.iter().all(|(_, scene)| is_rendered(scene));
        let none_rendered = !scenes.iter().any(|(_, scene)| is_rendered(scene));
        self.depths(document);
        self.views(document);
        for (pointer, camera) in places(document, "camera") {
            let side = |name| camera.get(name).and_then(Node::greatest).unwrap_or_default();
            let (width, height) = (side("width"), side("height"));
            if width * height > MAX_PIXELS as f64 {
                let message =
                    format!("`camera` can be {width}×{height} pixels, the limit is {MAX_PIXELS} pixels");
                self.refuse(|| FieldError::new(&pointer, message).limit(format!("{MAX_PIXELS} pixels")));
            }
            let mut refuse = |field: &str, needs: &str| {
                let message = format!("`camera.{}` needs {needs}", field.replace('/', "."));
                self.refuse(|| FieldError::new(&format!("{pointer}/{field}"), message));
            };
            let has = |name| camera.get(name).is_some();
            if has("rolling") && !has("path") {
                refuse("rolling", "`camera.path`: without movement all rows see the same");
            }
            if lags(camera) && !has("path") {
                refuse(
                    "exposure",
                    "`camera.path` for its `lag_frames`: without a sequence there is nothing to follow",
                );
            }
            if has("supersample") && !all_rendered {
                refuse(
                    "supersample",
                    "a procedural scene: a picture has the pixels it has",
                );
            }
            let shifts = |name| {
                let motion = camera.get("motion");
                motion
                    .and_then(|motion| motion.get(name))
                    .and_then(Node::greatest)
                    != Some(0.0)
            };
            if has("motion") && all_rendered && !has("path") {
                refuse("motion", "`camera.path`: without it nothing moves");
            }
            if has("motion") && none_rendered && !shifts("x_px") && !shifts("y_px") {
                refuse("motion", "`x_px` or `y_px`: a picture has no path to move along");
            }
        }
    }
}

impl Checker<'_> {
    /// More than 8 bits need a file that has them.
    fn depths(&mut self, document: &Node) {
        let is_png = |(_, encode): &(String, &Node)| {
            let format = encode.get("format").map(|format| format.strings(""));
            format.into_iter().flatten().all(|(_, name)| name == "png")
        };
        if places(document, "encode").iter().all(is_png) {
            return;
        }
        for (pointer, camera) in places(document, "camera") {
            if camera
                .get("bits")
                .and_then(Node::greatest)
                .is_some_and(|bits| bits > 8.0)
            {
                let message = "`camera.bits` of 16 need `encode` with the format \"png\"";
                self.refuse(|| FieldError::new(&format!("{pointer}/bits"), message));
            }
        }
    }
}

/// Whether the exposure of a camera can follow its metering slowly.
fn lags(camera: &Node) -> bool {
    let exposures = camera.get("exposure").map(|exposure| exposure.alternatives(""));
    exposures.into_iter().flatten().any(|(_, exposure)| {
        let metering = exposure.get("auto").map(|auto| auto.alternatives(""));
        let lag = |(_, auto): (String, &Node)| auto.get("lag_frames").and_then(Node::greatest);
        metering
            .into_iter()
            .flatten()
            .filter_map(lag)
            .any(|lag| lag > 0.0)
    })
}
