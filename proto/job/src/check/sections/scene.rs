//! Requirements on scenes: an error if no frame meets them, a warning if some frames do not. Water and lamps without a range are
//! always a warning.

mod requirements;

use std::collections::BTreeSet;

use serde_json::Value;

use crate::artifact::ArtifactKind;
use crate::check::Checker;
use crate::check::present::Contents;
use crate::check::values::find_values;
use crate::invalid::FieldError;
use crate::node::Node;
use crate::scene_parts::{ScenePart, SceneParts, Uploads};
use crate::schema::Names;

use self::requirements::{
    find_artifact_requirements, find_camera_requirements, find_lamp_requirements, find_water_requirements,
};
use requirements::{Lacking, Requirement, Selectable};

/// A possible scene of a frame.
struct Candidate {
    name: String,
    parts: SceneParts,
    /// Whether some frame certainly has it, as with a collection of which each scene is used.
    is_certain: bool,
}

impl Requirement {
    fn find_lacking<'l>(&self, lacking: &'l [Lacking]) -> &'l Lacking {
        &lacking[self.part as usize]
    }
}

impl Checker<'_> {
    /// Checks the requirements on scenes. Returns warnings for those that only some frames meet.
    pub(crate) fn check_scenes(&mut self, document: &Node, uploads: &Uploads) -> Vec<String> {
        let scenes = self.find_candidates(document, uploads);
        let mut warnings = Vec::new();
        if scenes.is_empty() {
            return warnings;
        }
        let has_camera = scenes.iter().all(|scene| scene.parts.camera);
        if has_camera && Contents::read(document).has_given("camera.hfov_deg", None) {
            let message = "`camera.hfov_deg` is given, but the scene has a camera; remove `camera.hfov_deg`";
            self.refuse(|| FieldError::new("/camera/hfov_deg", message));
        }
        let lacking = ScenePart::ALL.map(|part| find_lacking(&scenes, part));
        // A picture without range passes the water unchanged.
        for draws in [
            find_water_requirements(document),
            find_lamp_requirements(document),
        ] {
            warn_of_lacking(&draws, &lacking, &mut warnings);
        }
        for draws in [
            self.find_styles(document),
            find_camera_requirements(document),
            find_artifact_requirements(document),
        ] {
            if draws
                .iter()
                .all(|draw| draw.iter().any(|element| element.fails(&lacking)))
            {
                let failing = draws.iter().flatten().filter(|element| element.fails(&lacking));
                failing
                    .flat_map(|element| &element.requirements)
                    .for_each(|requirement| self.refuse_requirement(requirement, &lacking));
                continue;
            }
            warn_of_lacking(&draws, &lacking, &mut warnings);
        }
        warnings
    }

    fn refuse_requirement(&mut self, requirement: &Requirement, lacking: &[Lacking]) {
        let message = format!(
            "{} {}",
            requirement.name,
            needs(requirement, requirement.find_lacking(lacking))
        );
        let error = FieldError::new(&requirement.pointer, message)
            .value(&requirement.value)
            .limit(format!(
                "only with a scene that has {}",
                requirement.part.describe()
            ));
        let error = if requirement.pointer.starts_with("/artifacts") {
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
    fn find_candidates(&mut self, document: &Node, uploads: &Uploads) -> Vec<Candidate> {
        let mut scenes = Vec::new();
        let places = find_values(document, "scene");
        let is_only = places.len() == 1;
        for (pointer, scene) in places {
            if scene.get("family").is_some() {
                scenes.push(Candidate {
                    name: "a procedural scene".to_owned(),
                    parts: SceneParts::PROCEDURAL,
                    is_certain: false,
                });
            } else if let Some(id) = scene.get("id") {
                let takes_each = matches!(scene.get("each"), Some(Node::Constant(Value::Bool(true))));
                let ids = id.strings(&format!("{pointer}/id")).into_iter();
                let found = ids.filter_map(|(pointer, id)| self.find_uploaded(&pointer, id, uploads));
                scenes.extend(found.map(|scene| Candidate {
                    is_certain: is_only && takes_each,
                    ..scene
                }));
            } else if let Some(rgb) = scene.get("rgb") {
                let paths = rgb.strings("");
                scenes.push(Candidate {
                    name: format!("the scene of `{}`", paths.first().map_or("", |(_, path)| path)),
                    parts: SceneParts {
                        range: scene.get("range").or(scene.get("z_depth")).is_some(),
                        instances: scene.get("instances").is_some(),
                        ..SceneParts::default()
                    },
                    is_certain: false,
                });
            }
        }
        scenes
    }

    /// The styles of each water that use the range.
    fn find_styles(&self, document: &Node) -> Vec<Vec<Selectable>> {
        let waters = find_values(document, "water").into_iter();
        waters
            .map(|(pointer, water)| {
                let style = water.get("style").into_iter();
                style
                    .map(|style| self.find_style_requirements(&format!("{pointer}/style"), style))
                    .collect()
            })
            .collect()
    }

    fn find_style_requirements(&self, pointer: &str, style: &Node) -> Selectable {
        let names = style.strings(pointer).into_iter();
        let names = names.filter(|(_, name)| self.vocabulary.range_styles.iter().any(|known| known == name));
        Selectable {
            requirements: names
                .map(|(pointer, name)| Requirement {
                    pointer,
                    name: format!("the style \"{name}\""),
                    value: name.into(),
                    part: ScenePart::Range,
                })
                .collect(),
            values: style.alternatives(pointer).len(),
        }
    }

    fn find_uploaded(&mut self, pointer: &str, id: &str, uploads: &Uploads) -> Option<Candidate> {
        let parts = match uploads {
            Uploads::Unknown => Some(SceneParts::PROCEDURAL),
            Uploads::Known(known) => known.get(id).copied(),
        };
        if parts.is_none() {
            let message = if self.vocabulary.local {
                format!("scene `{id}` is stored in a service; submit the job there with `fathom submit`")
            } else {
                format!("scene `{id}` does not exist; upload it first")
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

/// Warns of each value that some frames are rendered without.
fn warn_of_lacking(draws: &[Vec<Selectable>], lacking: &[Lacking], warnings: &mut Vec<String>) {
    let mut named = BTreeSet::new();
    for requirement in draws.iter().flatten().flat_map(|element| &element.requirements) {
        let lacking = requirement.find_lacking(lacking);
        if lacking.count > 0 && named.insert((&requirement.name, requirement.part)) {
            let Requirement { pointer, name, .. } = requirement;
            let needs = needs(requirement, lacking);
            warnings.push(format!(
                "{name} at {pointer} {needs}; those frames are rendered without it"
            ));
        }
    }
}

fn find_lacking(scenes: &[Candidate], part: ScenePart) -> Lacking {
    let without: Vec<_> = scenes.iter().filter(|scene| !scene.parts.has(part)).collect();
    let certain = without.iter().find(|scene| scene.is_certain);
    Lacking {
        count: without.len(),
        first: certain.or(without.first()).map(|scene| scene.name.clone()),
        is_certain: certain.is_some() || without.len() == scenes.len(),
    }
}

/// `needs a range, which scene X lacks`.
fn needs(requirement: &Requirement, lacking: &Lacking) -> String {
    let part = requirement.part.describe();
    let first = lacking.first.as_deref().unwrap_or_default();
    match lacking.count {
        0 | 1 => format!("needs {part}, which {first} lacks"),
        2 => format!("needs {part}, which {first} and another scene lack"),
        more => format!("needs {part}, which {first} and {} other scenes lack", more - 1),
    }
}
