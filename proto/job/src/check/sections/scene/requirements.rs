//! The requirements of a description on its scenes.

use serde_json::Value;

use crate::artifact::ArtifactKind;
use crate::check::Location;
use crate::check::values::{find_lists, find_values};
use crate::node::Node;
use crate::scene_parts::ScenePart;

/// The requirements of each water.
pub(super) fn find_water_requirements(document: &Node) -> Vec<Vec<Selectable>> {
    find_range_requirements(document, "water", &["optics", "snow", "sediment"])
}

/// The requirements of each camera.
pub(super) fn find_camera_requirements(document: &Node) -> Vec<Vec<Selectable>> {
    find_range_requirements(document, "camera", &["defocus"])
}

/// Those of `fields` that an object has: each needs a range.
pub(super) fn find_range_requirements(
    document: &Node,
    object: &str,
    fields: &[&str],
) -> Vec<Vec<Selectable>> {
    let places = find_values(document, object).into_iter();
    places
        .map(|(pointer, node): (String, &Node)| {
            let fields = fields.iter();
            let present = fields.filter_map(|name| Some((name, node.get(name)?)));
            present
                .map(|(name, value)| Selectable {
                    requirements: vec![Requirement {
                        pointer: format!("{pointer}/{name}"),
                        name: format!("`{object}.{name}`"),
                        value: value.canonical(),
                        part: ScenePart::Range,
                    }],
                    values: 1,
                })
                .collect()
        })
        .collect()
}

/// The requirements of the lights of each list.
pub(super) fn find_lamp_requirements(document: &Node) -> Vec<Vec<Selectable>> {
    find_list_requirements(document, "lights", |location: &Location, item: &Node| {
        let lights = item.alternatives(&location.pointer);
        let values = lights.len();
        let lamps = lights
            .into_iter()
            .filter(|(_, light)| light.get("position_m").is_some());
        Selectable {
            requirements: lamps
                .map(|(pointer, light): (String, &Node)| Requirement {
                    pointer,
                    name: format!("the lamp {location}"),
                    value: light.canonical(),
                    part: ScenePart::Range,
                })
                .collect(),
            values,
        }
    })
}

/// The requirements of the artifacts of each list.
pub(super) fn find_artifact_requirements(document: &Node) -> Vec<Vec<Selectable>> {
    find_list_requirements(document, "artifacts", |location: &Location, item: &Node| {
        let kinds = item.strings(&location.pointer);
        let values = kinds.len();
        Selectable {
            requirements: kinds
                .into_iter()
                .filter_map(|(pointer, kind): (String, &str)| {
                    Some(Requirement {
                        part: ArtifactKind::parse(kind)?.needs()?,
                        pointer,
                        name: format!("the artifact \"{kind}\""),
                        value: kind.into(),
                    })
                })
                .collect(),
            values,
        }
    })
}

pub(super) fn find_list_requirements(
    document: &Node,
    name: &str,
    read_item: impl Fn(&Location, &Node) -> Selectable,
) -> Vec<Vec<Selectable>> {
    find_lists(document, name)
        .into_iter()
        .map(|(location, items): (Location, &[Node])| {
            let items = items.iter().enumerate();
            items
                .map(|(i, item)| read_item(&location.item(i), item))
                .collect()
        })
        .collect()
}

/// A value that needs a part of the scene.
pub(super) struct Requirement {
    pub(super) pointer: String,
    /// For messages.
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) part: ScenePart,
}

/// A field or list element.
pub(super) struct Selectable {
    /// The possible values that need a part of the scene.
    pub(super) requirements: Vec<Requirement>,
    /// Number of possible values.
    pub(super) values: usize,
}

impl Selectable {
    /// Whether each of its possible values needs a part that some frames certainly lack.
    pub(super) fn fails(&self, lacking: &[Lacking]) -> bool {
        let failing = self
            .requirements
            .iter()
            .filter(|requirement| requirement.find_lacking(lacking).is_certain);
        failing.count() == self.values
    }
}

/// The scenes without a part.
pub(super) struct Lacking {
    pub(super) count: usize,
    pub(super) first: Option<String>,
    /// Whether some frames certainly lack it: no scene has the part, or a certain one lacks it.
    pub(super) is_certain: bool,
}
