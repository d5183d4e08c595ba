//! Artifacts that relate a frame to the next one of its path, or its camera to another one.

use serde_json::Value;

use crate::artifact::ArtifactKind;
use crate::camera::Camera;
use crate::check::present::Contents;
use crate::check::{Checker, find_lists, find_values};
use crate::invalid::FieldError;
use crate::node::Node;
use crate::rules::Fault;

/// Minimum length of a path with a next frame.
const LEAST_FRAMES: f64 = 2.0;

impl Checker<'_> {
    /// Rejects frames without a neighbor on a path if they need one: the next frame for the artifact `flow`, the previous one
    /// for metrics.
    pub(crate) fn check_neighbors(&mut self, document: &Node, contents: &Contents<'_>) {
        if contents.has_given("artifacts.flow", None) {
            self.check_path_length(
                document,
                "the artifact \"flow\" needs a next frame",
                "the artifact",
            );
        }
        let requested = find_lists(document, "metrics")
            .into_iter()
            .flat_map(|(location, items)| {
                let items = items.iter().enumerate();
                let strings =
                    items.flat_map(move |(position, item)| item.strings(&location.item(position).pointer));
                strings.collect::<Vec<_>>()
            });
        let requested: Vec<_> = requested.collect();
        let path_metrics = self.vocabulary.path_metrics.iter();
        let asked = path_metrics.filter_map(|metric| requested.iter().find(|(_, name)| name == metric));
        let Some((pointer, metric)) = asked.min_by_key(|(pointer, _)| pointer.clone()) else {
            return;
        };
        if contents.is_certain("camera.path") {
            let reason = format!("the metric \"{metric}\" needs a previous frame");
            self.check_path_length(document, &reason, "the metric");
            return;
        }
        let message = format!(
            "the metric \"{metric}\" compares with the previous frame and needs `camera.path` in every frame: add it, or remove \
             the metric"
        );
        self.refuse(|| FieldError::new(pointer, message).value(&Value::from(*metric)));
    }

    /// Rejects paths of one frame.
    fn check_path_length(&mut self, document: &Node, reason: &str, removable: &str) {
        for (pointer, camera) in find_values(document, "camera") {
            let pointer = format!("{pointer}/path");
            let paths = camera.get("path").map(|path| path.alternatives(&pointer));
            for (pointer, path) in paths.into_iter().flatten() {
                let frames = path.get("frames").and_then(Node::greatest);
                if let Some(frames) = frames.filter(|frames| *frames < LEAST_FRAMES) {
                    let message = format!(
                        "`camera.path.frames` is {frames}, but {reason}: must be at least {LEAST_FRAMES}, or remove {removable}"
                    );
                    self.refuse(|| {
                        FieldError::new(&format!("{pointer}/frames"), message)
                            .value(&Value::from(frames as u64))
                            .limit(format!("at least {LEAST_FRAMES}"))
                    });
                }
            }
        }
    }
}

impl Checker<'_> {
    /// The first requested artifact or metric that needs one pose for all rows.
    pub(super) fn find_needs_of_one_pose(&self, contents: &Contents<'_>) -> Option<String> {
        let kinds = ArtifactKind::FIXED
            .iter()
            .filter(|(_, kind)| kind.needs_one_pose());
        let artifacts = kinds.map(|(name, _)| ("artifact", *name));
        let metrics = self
            .vocabulary
            .path_metrics
            .iter()
            .map(|name| ("metric", name.as_str()));
        let mut requested = artifacts
            .chain(metrics)
            .filter(|(field, name)| contents.has_given(&format!("{field}s.{name}"), None));
        requested
            .next()
            .map(|(field, name)| format!("the {field} \"{name}\""))
    }
}

/// The faults of a camera with a rolling shutter if something needs one pose for all rows.
pub(super) fn find_rolling_faults(camera: &Camera, readout_s: f64, one_pose: Option<&str>) -> Vec<Fault> {
    let Some(what) = one_pose.filter(|_| readout_s > 0.0) else {
        return Vec::new();
    };
    let source = if camera.readout_s.is_some() {
        ""
    } else {
        " from its preset"
    };
    vec![Fault {
        path: vec!["readout_s"],
        message: format!(
            "`camera.readout_s` is {readout_s}{source}, but {what} needs one pose for all rows: set it to 0, or remove it"
        ),
        missing: false,
    }]
}
