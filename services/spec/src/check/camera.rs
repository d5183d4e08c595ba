use std::collections::BTreeSet;

use imaging::codec::MAX_PIXELS;

use super::Checker;
use super::places::places;
use crate::camera::Camera;
use crate::invalid::FieldError;
use crate::node::Node;

impl Checker<'_> {
    /// Tries the camera with each kind of scene.
    pub(crate) fn cameras(&mut self, document: &Node, frames: u64) {
        let Some(camera) = document.get("camera") else {
            return;
        };
        let scenes = places(document, "scene");
        let kinds: BTreeSet<bool> = scenes
            .iter()
            .map(|(_, scene): &(String, &Node)| scene.get("family").is_some())
            .collect();
        let find_faults = self.vocabulary.camera_rules.faults;
        self.try_values("camera", camera, frames, &|camera: &Camera| {
            kinds
                .iter()
                .flat_map(|renders| find_faults(camera, *renders))
                .collect()
        });
    }

    /// Checks the image size and the file format for its codes.
    pub(super) fn camera(&mut self, document: &Node) {
        let all_png = places(document, "encode")
            .iter()
            .all(|(_, encode): &(String, &Node)| {
                let format = encode.get("format").map(|format| format.strings(""));
                format.into_iter().flatten().all(|(_, name)| name == "png")
            });
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
