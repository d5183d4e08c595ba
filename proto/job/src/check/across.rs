//! Checks across fields, except for the water.

use serde_json::Value;

use super::Checker;
use super::present::Contents;
use super::values::find_values;
use crate::invalid::FieldError;
use crate::node::Node;
use crate::schema::describe;

/// The parts of a frame that each artifact is derived from.
const NEEDS: [(&str, &[&str]); 5] = [
    ("snow_mask", &["water.snow", "water.sediment"]),
    ("raw", &["camera.sensor", "camera.preset"]),
    ("flow", &["camera.path"]),
    ("rgb_right", &["camera.stereo"]),
    ("disparity", &["camera.stereo"]),
];

impl Checker<'_> {
    /// Checks a description without its invalid fields.
    pub(crate) fn check_across(&mut self, document: &Node) {
        let contents = Contents::read(document);
        self.check_rules(&contents);
        self.check_image(document);
        self.check_waypoints(document);
        self.check_haze(document);
        self.check_daylight(document, &contents);
        self.check_artifacts(document, &contents);
        self.check_enhance(document);
        self.check_network_sizes(document);
        self.check_neighbors(document, &contents);
        self.check_truth_work(document, &contents);
    }

    /// Artifacts that need another part of the frame.
    fn check_artifacts(&mut self, document: &Node, contents: &Contents<'_>) {
        for (artifact, paths) in NEEDS {
            if paths.iter().any(|path| contents.has_given(path, None)) {
                continue;
            }
            for (pointer, list) in find_values(document, "artifacts") {
                let Node::List(items) = list else { continue };
                let kinds = items.iter().enumerate();
                for (pointer, kind) in kinds.flat_map(|(i, item)| item.strings(&format!("{pointer}/{i}"))) {
                    if kind == artifact {
                        let message = format!(
                            "the artifact \"{artifact}\" needs {}: add it, or remove the artifact",
                            describe(paths)
                        );
                        self.refuse(|| FieldError::new(&pointer, message).value(&Value::from(kind)));
                    }
                }
            }
        }
    }
}
