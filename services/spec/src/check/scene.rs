//! Requirements on scenes: an error if no frame meets them, a warning if some frames do not.

use std::collections::BTreeSet;

use serde_json::Value;

use super::places::{lists, places};
use super::present::Contents;
use super::{Checker, Place};
use crate::artifact::ArtifactKind;
use crate::invalid::FieldError;
use crate::node::Node;
use crate::scene_parts::{ScenePart, SceneParts, Uploads};
use crate::schema::Names;

/// A possible scene of a frame.
struct Candidate {
    name: String,
    parts: SceneParts,
    /// Whether some frame certainly has it, as with a collection of which each scene is used.
    is_certain: bool,
}

/// A value that needs a part of the scene.
struct Ask {
    pointer: String,
    /// For messages.
    name: String,
    value: Value,
    part: ScenePart,
}

/// A field or list element.
struct Element {
    /// The possible values that need a part of the scene.
    asks: Vec<Ask>,
    /// Number of possible values.
    values: usize,
}

/// The scenes without a part.
struct Lacking {
    count: usize,
    first: Option<String>,
    /// Whether some frames certainly lack it: no scene has the part, or a certain one lacks it.
    is_certain: bool,
}

impl Checker<'_> {
    /// Checks the requirements on scenes. Returns warnings for those that only some frames meet.
    pub(crate) fn scenes(&mut self, document: &Node, uploads: &Uploads) -> Vec<String> {
        let scenes = self.candidates(document, uploads);
        let mut warnings = Vec::new();
        if scenes.is_empty() {
            return warnings;
        }
        let brings_camera = scenes.iter().all(|scene| scene.parts.camera);
        if brings_camera && Contents::read(document).has_given("camera.hfov_deg", None) {
            let message =
                "`camera.hfov_deg` is given, but the scene brings its own camera: remove `camera.hfov_deg`";
            self.refuse(|| FieldError::new("/camera/hfov_deg", message));
        }
        let lacking = ScenePart::ALL.map(|part| lacking(&scenes, part));
        let of = |ask: &Ask| &lacking[ask.part as usize];
        let fails = |element: &&Element| {
            element.asks.iter().filter(|ask| of(ask).is_certain).count() == element.values
        };
        for draws in [
            waters(document),
            self.styles(document),
            cameras(document),
            lamps(document),
            artifacts(document),
        ] {
            if draws
                .iter()
                .all(|draw| draw.iter().any(|element| fails(&element)))
            {
                let failing = draws.iter().flatten().filter(fails);
                failing
                    .flat_map(|element| &element.asks)
                    .for_each(|ask| self.refuse_ask(ask, &lacking));
                continue;
            }
            let mut named = BTreeSet::new();
            for ask in draws.iter().flatten().flat_map(|element| &element.asks) {
                if of(ask).count > 0 && named.insert((&ask.name, ask.part)) {
                    let Ask { pointer, name, .. } = ask;
                    let needs = needs(ask, of(ask));
                    warnings.push(format!("{name} at {pointer} {needs}: such frames go without it"));
                }
            }
        }
        warnings
    }

    fn refuse_ask(&mut self, ask: &Ask, lacking: &[Lacking]) {
        let message = format!("{} {}", ask.name, needs(ask, &lacking[ask.part as usize]));
        let error = FieldError::new(&ask.pointer, message)
            .value(&ask.value)
            .limit(format!("only over a scene with {}", ask.part.describe()));
        let error = if ask.pointer.starts_with("/artifacts") {
            let kinds = self.vocabulary.listed(Names::Artifact);
            error.allowed(
                kinds.into_iter().filter(|name: &String| {
                    let part = ArtifactKind::parse(name).and_then(|kind| kind.needs());
                    part.is_none_or(|part| !lacking[part as usize].is_certain)
                }),
                "",
            )
        } else {
            error
        };
        self.refuse(|| error);
    }

    /// The possible scenes of a frame. Rejects uploaded scenes that do not exist.
    fn candidates(&mut self, document: &Node, uploads: &Uploads) -> Vec<Candidate> {
        let mut scenes = Vec::new();
        let places = places(document, "scene");
        let is_only = places.len() == 1;
        for (pointer, scene) in places {
            let has = |name| scene.get(name).is_some();
            if has("family") {
                scenes.push(Candidate {
                    name: "a procedural scene".to_owned(),
                    parts: SceneParts::PROCEDURAL,
                    is_certain: false,
                });
            } else if let Some(id) = scene.get("id") {
                let takes_each = matches!(scene.get("each"), Some(Node::Constant(Value::Bool(true))));
                let ids = id.strings(&format!("{pointer}/id")).into_iter();
                let found = ids.filter_map(|(pointer, id)| self.uploaded(&pointer, id, uploads));
                scenes.extend(found.map(|scene| Candidate {
                    is_certain: is_only && takes_each,
                    ..scene
                }));
            } else if let Some(rgb) = scene.get("rgb") {
                let paths = rgb.strings("");
                scenes.push(Candidate {
                    name: format!("the scene of `{}`", paths.first().map_or("", |(_, path)| path)),
                    parts: SceneParts {
                        range: has("range") || has("z_depth"),
                        instances: has("instances"),
                        ..SceneParts::default()
                    },
                    is_certain: false,
                });
            }
        }
        scenes
    }

    /// The styles of each water that use the range.
    fn styles(&self, document: &Node) -> Vec<Vec<Element>> {
        let of_water = |(pointer, water): (String, &Node)| {
            let pointer = format!("{pointer}/style");
            let style = water.get("style")?;
            let needs_range =
                |(_, name): &(String, &str)| self.vocabulary.range_styles.iter().any(|known| known == name);
            let asks = style.strings(&pointer).into_iter().filter(needs_range);
            let ask = |(pointer, name): (String, &str)| Ask {
                pointer,
                name: format!("the style \"{name}\""),
                value: name.into(),
                part: ScenePart::Range,
            };
            Some(Element {
                asks: asks.map(ask).collect(),
                values: style.alternatives(&pointer).len(),
            })
        };
        let waters = places(document, "water").into_iter();
        waters
            .map(|water| of_water(water).into_iter().collect())
            .collect()
    }

    fn uploaded(&mut self, pointer: &str, id: &str, uploads: &Uploads) -> Option<Candidate> {
        let parts = match uploads {
            Uploads::Unknown => Some(SceneParts::PROCEDURAL),
            Uploads::Known(known) => known.get(id).copied(),
        };
        if parts.is_none() {
            let message = if self.vocabulary.local {
                format!(
                    "scene `{id}` was uploaded to a service and can only be rendered by one of its workers"
                )
            } else {
                format!("scene `{id}` was not uploaded")
            };
            self.refuse(|| FieldError::new(pointer, message).value(&id.into()));
        }
        Some(Candidate {
            name: format!("scene `{id}`"),
            parts: parts?,
            is_certain: false,
        })
    }
}

fn lacking(scenes: &[Candidate], part: ScenePart) -> Lacking {
    let without = || scenes.iter().filter(|scene| !scene.parts.has(part));
    let certain = without().find(|scene| scene.is_certain);
    let count = without().count();
    Lacking {
        count,
        first: certain.or(without().next()).map(|scene| scene.name.clone()),
        is_certain: certain.is_some() || count == scenes.len(),
    }
}

/// `needs a range, which scene X lacks`.
fn needs(ask: &Ask, lacking: &Lacking) -> String {
    let part = ask.part.describe();
    let first = lacking.first.as_deref().unwrap_or_default();
    match lacking.count {
        0 | 1 => format!("needs {part}, which {first} lacks"),
        2 => format!("needs {part}, which {first} and another scene lack"),
        more => format!("needs {part}, which {first} and {} other scenes lack", more - 1),
    }
}

/// The requirements of each water.
fn waters(document: &Node) -> Vec<Vec<Element>> {
    needing_range(document, "water", &["optics", "snow", "sediment"])
}

/// The requirements of each camera.
fn cameras(document: &Node) -> Vec<Vec<Element>> {
    needing_range(document, "camera", &["defocus"])
}

/// Those of `fields` that an object has: each needs a range.
fn needing_range(document: &Node, object: &str, fields: &[&str]) -> Vec<Vec<Element>> {
    let asked = |pointer: &str, node: &Node, name: &str| {
        let value = node.get(name)?.canonical();
        let ask = Ask {
            pointer: format!("{pointer}/{name}"),
            name: format!("`{object}.{name}`"),
            value,
            part: ScenePart::Range,
        };
        Some(Element {
            asks: vec![ask],
            values: 1,
        })
    };
    let places = places(document, object).into_iter();
    places
        .map(|(pointer, node): (String, &Node)| {
            let fields = fields.iter();
            fields.filter_map(|name| asked(&pointer, node, name)).collect()
        })
        .collect()
}

/// The requirements of the lights of each list.
fn lamps(document: &Node) -> Vec<Vec<Element>> {
    elements(document, "lights", |at: &Place, item: &Node| {
        let lights = item.alternatives(&at.pointer);
        let values = lights.len();
        let lamps = lights
            .into_iter()
            .filter(|(_, light)| light.get("position_m").is_some());
        Element {
            asks: lamps
                .map(|(pointer, light): (String, &Node)| Ask {
                    pointer,
                    name: format!("the lamp {at}"),
                    value: light.canonical(),
                    part: ScenePart::Range,
                })
                .collect(),
            values,
        }
    })
}

/// The requirements of the artifacts of each list.
fn artifacts(document: &Node) -> Vec<Vec<Element>> {
    elements(document, "artifacts", |at: &Place, item: &Node| {
        let kinds = item.strings(&at.pointer);
        let values = kinds.len();
        Element {
            asks: kinds
                .into_iter()
                .filter_map(|(pointer, kind): (String, &str)| {
                    Some(Ask {
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

fn elements(document: &Node, name: &str, of_item: impl Fn(&Place, &Node) -> Element) -> Vec<Vec<Element>> {
    lists(document, name)
        .into_iter()
        .map(|(at, items): (Place, &[Node])| {
            let items = items.iter().enumerate();
            items.map(|(i, item)| of_item(&at.item(i), item)).collect()
        })
        .collect()
}
