use std::collections::BTreeSet;

use imaging::codec::MAX_PIXELS;

use crate::camera::Camera;
use crate::check::Checker;
use crate::check::present::Contents;
use crate::check::values::find_values;
use crate::invalid::FieldError;
use crate::node::Node;

use super::sequences::find_rolling_faults;

impl Checker<'_> {
    /// Tries the camera with each kind of scene.
    pub(crate) fn try_cameras(&mut self, document: &Node, frames: u64) {
        let Some(camera) = document.get("camera") else {
            return;
        };
        let scenes = find_values(document, "scene");
        let kinds: BTreeSet<bool> = scenes
            .iter()
            .map(|(_, scene): &(String, &Node)| scene.get("family").is_some())
            .collect();
        let rules = self.vocabulary.camera_rules;
        let contents = Contents::read(document);
        let one_pose = self.find_needs_of_one_pose(&contents);
        self.try_values("camera", camera, frames, &|camera: &Camera| {
            let faults = kinds.iter().flat_map(|renders| (rules.faults)(camera, *renders));
            let rolling = find_rolling_faults(camera, (rules.readout_s)(camera), one_pose.as_deref());
            faults.chain(rolling).collect()
        });
    }

    /// Checks the image size and the file format for its codes.
    pub(crate) fn check_image(&mut self, document: &Node) {
        let all_png = find_values(document, "encode")
            .iter()
            .all(|(_, encode): &(String, &Node)| {
                let format = encode.get("format").map(|format| format.strings(""));
                format.into_iter().flatten().all(|(_, name)| name == "png")
            });
        for (pointer, camera) in find_values(document, "camera") {
            let [width, height, bits] = ["width", "height", "bits"]
                .map(|name| camera.get(name).and_then(Node::greatest).unwrap_or_default());
            if width * height > MAX_PIXELS as f64 {
                let message =
                    format!("`camera` can be {width}×{height} pixels; must be at most {MAX_PIXELS} pixels");
                self.refuse(|| FieldError::new(&pointer, message).limit(format!("{MAX_PIXELS} pixels")));
            }
            if bits > 8.0 && !all_png {
                let message = format!(
                    "`camera.bits` is {bits}, but only PNG supports more than 8: set `encode.format` to \"png\""
                );
                self.refuse(|| FieldError::new(&format!("{pointer}/bits"), message));
            }
        }
    }
}
