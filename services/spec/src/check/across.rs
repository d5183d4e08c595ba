//! What must fit together across fields, apart from the water.

use std::collections::BTreeSet;

use serde_json::Value;

use super::places::{is_zero, places};
use super::{Checker, Place};
use crate::invalid::FieldError;
use crate::node::Node;

impl Checker<'_> {
    /// Checks a description whose fields are right by themselves; those that are not are missing here.
    pub(crate) fn across(&mut self, document: &Node) {
        self.camera(document);
        self.scene_files(document);
        self.lights(document);
        self.verticals(document);
        self.daylight(document);
        self.path(document);
        self.artifacts(document);
        self.truth(document);
    }

    /// A path goes through one world, from one place to another.
    fn path(&mut self, document: &Node) {
        for (pointer, camera) in places(document, "camera") {
            let Some(path) = camera.get("path") else { continue };
            for (pointer, path) in path.alternatives(&format!("{pointer}/path")) {
                let number = |name| path.get(name).and_then(Node::greatest);
                if let (Some(frame), Some(frames)) = (number("frame"), number("frames"))
                    && frame >= frames
                {
                    let message = format!("`camera.path.frame` is {frame}, but the path has {frames} frames");
                    self.refuse(|| {
                        FieldError::new(&format!("{pointer}/frame"), message).limit("below `frames`")
                    });
                }
                match (path.get("start"), path.get("end")) {
                    (Some(start), Some(end)) if start.canonical() == end.canonical() => {
                        let message = "`camera.path` ends where it starts: its length is 0";
                        self.refuse(|| {
                            FieldError::new(&format!("{pointer}/end"), message)
                                .limit("at least 0.001 m from `start`")
                        });
                    }
                    (Some(_), None) | (None, Some(_)) => {
                        let message = "`camera.path` takes `start` and `end` together, or neither";
                        self.refuse(|| FieldError::new(&pointer, message));
                    }
                    _ => {}
                }
            }
            let still = |(_, scene): &(String, &Node)| scene.get("family").is_none();
            if places(document, "scene").iter().any(still) {
                let message = "`camera.path` needs a procedural scene";
                self.refuse(|| FieldError::new(&format!("{pointer}/path"), message));
            }
        }
    }

    /// A picture may say where up is; a procedural scene knows.
    fn verticals(&mut self, document: &Node) {
        let scenes = places(document, "scene");
        let all_rendered = scenes.iter().all(|(_, scene)| scene.get("family").is_some());
        for (pointer, camera) in places(document, "camera") {
            let Some(up) = camera.get("up") else { continue };
            let at = format!("{pointer}/up");
            if is_zero(up) {
                let message = "`camera.up` is [0, 0, 0], which is no direction";
                self.refuse(|| FieldError::new(&at, message).limit("a length above 0"));
            }
            if all_rendered {
                let message = "`camera.up` needs a picture: a procedural scene knows where up is";
                self.refuse(|| FieldError::new(&at, message));
            }
        }
    }

    fn scene_files(&mut self, document: &Node) {
        for (pointer, scene) in places(document, "scene") {
            let has = |name| scene.get(name).is_some();
            let at = Place {
                pointer,
                name: "scene".to_owned(),
            };
            if has("range") && has("z_depth") {
                let at = at.field("z_depth");
                self.refuse(|| {
                    FieldError::new(
                        &at.pointer,
                        "`scene` has both `range` and `z_depth`, give one of them",
                    )
                });
            }
            if has("classes") && !has("instances") {
                let at = at.field("classes");
                let message = format!("{at} says what the objects of `instances` are, which is not given");
                self.refuse(|| FieldError::new(&at.pointer, message));
            }
            for name in ["unit_m", "invalid_code"] {
                if has(name) && !has("range") && !has("z_depth") {
                    let at = at.field(name);
                    let message =
                        format!("{at} describes a range file, but neither `range` nor `z_depth` is given");
                    self.refuse(|| FieldError::new(&at.pointer, message));
                }
            }
        }
    }

    fn artifacts(&mut self, document: &Node) {
        let has = |object: &str, field: &str| {
            let objects = places(document, object);
            objects.iter().any(|(_, object)| object.get(field).is_some())
        };
        let senses = has("camera", "sensor") || has("camera", "preset");
        let lacks = [
            (
                "snow_mask",
                "`water.snow`",
                !has("water", "snow") && !has("water", "sediment"),
            ),
            ("raw", "`camera.sensor`", !senses),
        ];
        for (pointer, list) in places(document, "artifacts") {
            let Node::List(items) = list else { continue };
            let kinds = items.iter().enumerate();
            for (pointer, kind) in kinds.flat_map(|(i, item)| item.strings(&format!("{pointer}/{i}"))) {
                let lacking = lacks.iter().find(|(name, _, lacks)| *lacks && *name == kind);
                if let Some((name, needs, _)) = lacking {
                    let message = format!("the artifact \"{name}\" needs {needs}");
                    self.refuse(|| FieldError::new(&pointer, message).value(&Value::from(kind)));
                }
            }
        }
        if document.get("enhance").is_none() {
            return;
        }
        let runs: Vec<_> = places(document, "enhance")
            .iter()
            .map(|(_, list)| certain(list))
            .collect();
        for (pointer, list) in places(document, "artifacts") {
            let Node::List(items) = list else { continue };
            for (position, item) in items.iter().enumerate() {
                for (pointer, kind) in item.strings(&format!("{pointer}/{position}")) {
                    let method = if kind == "hscm_mask" {
                        "hscm"
                    } else {
                        kind.strip_prefix("enhanced.").unwrap_or_default()
                    };
                    if !method.is_empty() && !runs.iter().all(|names| names.contains(method)) {
                        let message =
                            format!("the artifact \"{kind}\" needs \"{method}\" in `enhance` of every frame");
                        self.refuse(|| FieldError::new(&pointer, message).value(&Value::from(kind)));
                    }
                }
            }
        }
    }
}

/// The names that a list holds in every frame.
fn certain(list: &Node) -> BTreeSet<&str> {
    let Node::List(items) = list else {
        return BTreeSet::new();
    };
    let only = |item| {
        let names: BTreeSet<_> = Node::strings(item, "")
            .into_iter()
            .map(|(_, name)| name)
            .collect();
        if names.len() == 1 {
            names.into_iter().next()
        } else {
            None
        }
    };
    items.iter().filter_map(only).collect()
}
