//! What must fit together between light from above and the scene that it falls on.

use super::{Checker, places};
use crate::invalid::FieldError;
use crate::node::Node;

impl Checker<'_> {
    /// A picture that is lit already is not lit again, and reflectance alone is no light.
    pub(super) fn daylight(&mut self, document: &Node) {
        let scenes = places(document, "scene");
        let is = |wanted: &str| scenes.iter().any(|(_, scene)| may_show(scene, wanted));
        let (baked, albedo) = (is("baked"), is("albedo"));
        for (pointer, water) in places(document, "water") {
            let surfaces = above(&pointer, water)
                .into_iter()
                .flat_map(|(at, above)| named(&at, above, "surfaces"));
            for at in surfaces.filter_map(|(at, name)| (name == "normal").then_some(at)) {
                if baked {
                    let message = "`water.from_above.surfaces` is \"normal\", but the scene is lit already";
                    self.refuse(|| {
                        FieldError::new(&at, message)
                            .value(&"normal".into())
                            .limit("`scene.light` \"albedo\", or \"depth\"")
                    });
                }
            }
            for (at, name) in named(&pointer, water, "ambient") {
                if albedo && name != "none" {
                    let message = format!(
                        "`water.ambient` is \"{name}\", but the scene shows reflectance, which `water.from_above.surfaces` lights"
                    );
                    self.refuse(|| {
                        FieldError::new(&at, message)
                            .value(&name.into())
                            .limit("\"none\"")
                    });
                }
            }
        }
    }
}

/// Every light from above that a water can have.
pub(crate) fn above<'a>(pointer: &str, water: &'a Node) -> Vec<(String, &'a Node)> {
    let above = water.get("from_above");
    above.map_or_else(Vec::new, |above| {
        above.alternatives(&format!("{pointer}/from_above"))
    })
}

/// Every text that can stand in a field.
fn named<'a>(pointer: &str, object: &'a Node, field: &str) -> Vec<(String, &'a str)> {
    let node = object.get(field);
    node.map_or_else(Vec::new, |node| node.strings(&format!("{pointer}/{field}")))
}

/// Whether the picture of a scene may be of this kind.
pub(crate) fn may_show(scene: &Node, kind: &str) -> bool {
    match scene.get("light") {
        Some(light) => light.strings("").iter().any(|(_, name)| *name == kind),
        None => kind == "baked",
    }
}
