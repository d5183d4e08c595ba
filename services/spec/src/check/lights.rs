//! What must fit together within and between the lights.

use serde_json::Value;

use super::Checker;
use super::places::{is_zero, lists, places};
use crate::invalid::FieldError;
use crate::node::Node;

impl Checker<'_> {
    pub(super) fn lights(&mut self, document: &Node) {
        self.light_spaces(document);
        self.lamp_axes(document);
        self.lamp_shadows(document);
        self.rays(document);
    }

    fn lamp_axes(&mut self, document: &Node) {
        for (pointer, light) in lights(document) {
            if light.get("direction").is_some_and(is_zero) {
                let message = "this lamp's `direction` is [0, 0, 0], which is none";
                self.refuse(|| {
                    FieldError::new(&format!("{pointer}/direction"), message).limit("a length above 0")
                });
            }
        }
    }

    /// What belongs to a kind of shadow stands beside it.
    fn lamp_shadows(&mut self, document: &Node) {
        for (pointer, light) in lights(document) {
            let forms: Vec<&str> = match light.get("shadow") {
                Some(form) => form.strings("").into_iter().map(|(_, form)| form).collect(),
                None => vec!["none"],
            };
            let can_be = |form: &str| forms.contains(&form);
            // A radius that is wrong by itself is missing here.
            let radius = format!("{pointer}/radius_m");
            let is_wrong = self.errors.iter().any(|error| error.pointer.starts_with(&radius));
            if can_be("soft") && light.get("radius_m").is_none() && !is_wrong {
                let message = "a lamp with a soft shadow needs `radius_m`";
                self.refuse(|| {
                    FieldError::new(&format!("{pointer}/shadow"), message).value(&Value::from("soft"))
                });
            }
            for field in ["radius_m", "samples"] {
                if light.get(field).is_some() && !can_be("soft") {
                    let message = format!("this lamp's `{field}` needs its `shadow` to be \"soft\"");
                    self.refuse(|| FieldError::new(&format!("{pointer}/{field}"), message));
                }
            }
            if light.get("glow_shadow").is_some() && forms.iter().all(|form| *form == "none") {
                let message = "this lamp's `glow_shadow` needs its `shadow` to be \"hard\" or \"soft\"";
                self.refuse(|| FieldError::new(&format!("{pointer}/glow_shadow"), message));
            }
        }
    }

    /// Solids are known of procedural scenes alone.
    fn rays(&mut self, document: &Node) {
        for (pointer, _) in places(document, "rays")
            .iter()
            .flat_map(|(pointer, rays)| rays.strings(pointer))
            .filter(|(_, rays)| *rays == "scene")
        {
            if places(document, "scene")
                .iter()
                .any(|(_, scene)| scene.get("family").is_none())
            {
                let message = "`rays` asks for the solids of the scene, which only a procedural one has";
                self.refuse(|| {
                    FieldError::new(&pointer, message)
                        .value(&Value::from("scene"))
                        .limit("\"auto\" or \"screen\"")
                });
            }
        }
    }

    fn light_spaces(&mut self, document: &Node) {
        let mut first: Option<String> = None;
        for (pointer, space) in spaces(document) {
            match &first {
                None => first = Some(space.to_owned()),
                Some(first) if first == space => {}
                Some(first) => {
                    let message =
                        format!("this light's `space` is \"{space}\", but another's is \"{first}\"");
                    self.refuse(|| {
                        FieldError::new(&pointer, message)
                            .value(&space.into())
                            .limit("the same for all haze")
                    });
                }
            }
        }
    }
}

/// Whether a frame can have lamps.
pub(crate) fn has_lamps(document: &Node) -> bool {
    lights(document)
        .iter()
        .any(|(_, light)| light.get("position_m").is_some())
}

/// Every light that can be, with its pointer.
fn lights(document: &Node) -> Vec<(String, &Node)> {
    let mut lights = Vec::new();
    for (at, items) in lists(document, "lights") {
        for (position, item) in items.iter().enumerate() {
            lights.extend(item.alternatives(&at.item(position).pointer));
        }
    }
    lights
}

/// The space of all haze that can be, with its pointer.
fn spaces(document: &Node) -> Vec<(String, &str)> {
    let all = lights(document).into_iter();
    let nodes = all.filter_map(|(pointer, light)| Some((pointer, light.get("space")?)));
    nodes
        .flat_map(|(pointer, node)| node.strings(&format!("{pointer}/space")))
        .collect()
}
