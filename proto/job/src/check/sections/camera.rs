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

    /// Rejects waypoints below the bottom, which is at the height 0 of every procedural world.
    pub(crate) fn check_waypoints(&mut self, document: &Node) {
        for (pointer, position) in list_waypoints(document) {
            let Node::List(coordinates) = position else {
                continue;
            };
            let Some(height_m) = coordinates.get(2).and_then(Node::least).filter(|z| *z < 0.0) else {
                continue;
            };
            let message = format!(
                "a waypoint of `camera.path` is at a height of {height_m} m, below the bottom: `position_m[2]` must be at least 0"
            );
            self.refuse(|| {
                FieldError::new(&format!("{pointer}/2"), message)
                    .value(&coordinates[2].canonical())
                    .limit("at least 0")
            });
        }
    }
}

/// The possible positions of all waypoints, with their pointers.
fn list_waypoints(document: &Node) -> Vec<(String, &Node)> {
    let mut positions = Vec::new();
    for (pointer, camera) in find_values(document, "camera") {
        let paths = camera
            .get("path")
            .map(|path| path.alternatives(&format!("{pointer}/path")));
        for (pointer, path) in paths.into_iter().flatten() {
            for end in ["start", "end"] {
                let pointer = format!("{pointer}/{end}");
                let waypoints = path.get(end).map(|waypoint| waypoint.alternatives(&pointer));
                for (pointer, waypoint) in waypoints.into_iter().flatten() {
                    let pointer = format!("{pointer}/position_m");
                    let position = waypoint.get("position_m").map(|node| node.alternatives(&pointer));
                    positions.extend(position.into_iter().flatten());
                }
            }
        }
    }
    positions
}
