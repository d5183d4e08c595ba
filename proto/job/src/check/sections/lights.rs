use crate::check::Checker;
use crate::check::values::find_lists;
use crate::invalid::FieldError;
use crate::node::Node;

impl Checker<'_> {
    /// All haze must use the same color space.
    pub(crate) fn check_haze(&mut self, document: &Node) {
        let mut first: Option<String> = None;
        for (pointer, space) in list_spaces(document) {
            match &first {
                None => first = Some(space.to_owned()),
                Some(first) if first == space => {}
                Some(first) => {
                    let message = format!(
                        "a haze has `space` \"{space}\", but another \"{first}\"; all must have the same"
                    );
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
    list_lights(document)
        .iter()
        .any(|(_, light)| light.get("position_m").is_some())
}

/// Whether a frame can be without lamps.
pub(crate) fn can_lack_lamps(document: &Node) -> bool {
    find_lists(document, "lights").iter().any(|(_, items)| {
        items.iter().all(|item| {
            let lights = item.alternatives("");
            lights.iter().any(|(_, light)| light.get("position_m").is_none())
        })
    })
}

/// Every possible light, with its pointer.
fn list_lights(document: &Node) -> Vec<(String, &Node)> {
    let mut lights = Vec::new();
    for (location, items) in find_lists(document, "lights") {
        for (position, item) in items.iter().enumerate() {
            lights.extend(item.alternatives(&location.item(position).pointer));
        }
    }
    lights
}

/// The color space of each possible haze, with its pointer.
fn list_spaces(document: &Node) -> Vec<(String, &str)> {
    let all = list_lights(document).into_iter();
    let nodes = all.filter_map(|(pointer, light)| Some((pointer, light.get("space")?)));
    nodes
        .flat_map(|(pointer, node)| node.strings(&format!("{pointer}/space")))
        .collect()
}
