//! What the truth of a frame cannot be traced with.

use super::{Checker, places};
use crate::artifact::ArtifactKind;
use crate::invalid::FieldError;
use crate::node::Node;
use crate::truth::{TooMuch, Truth};

/// Parts of a camera that see other rays than its pixels, and why the truth has none of them.
const LENSES: [&str; 6] = ["preset", "distortion", "port", "supersample", "motion", "rolling"];

/// Whether a frame can ask for its light by Monte Carlo.
pub(crate) fn is_traced(document: &Node) -> bool {
    let lists = places(document, "artifacts");
    let mut names = lists.iter().flat_map(|(pointer, list)| match list {
        Node::List(items) => items.iter().flat_map(|item| item.strings(pointer)).collect(),
        _ => Vec::new(),
    });
    names.any(|(_, name)| ArtifactKind::parse(name).is_some_and(|kind| kind.is_traced()))
}

impl Checker<'_> {
    /// What stands beside an artifact of the truth and has no part in it would make a comparison of two different things.
    pub(super) fn truth(&mut self, document: &Node) {
        if !is_traced(document) {
            return;
        }
        self.truth_work(document);
        for (pointer, camera) in places(document, "camera") {
            for name in LENSES.into_iter().filter(|name| camera.get(name).is_some()) {
                self.untraced(
                    &format!("{pointer}/{name}"),
                    &format!("camera.{name}"),
                    "a pinhole camera is traced",
                );
            }
        }
        for (pointer, water) in places(document, "water") {
            if water.get("sediment").is_some() {
                let at = format!("{pointer}/sediment");
                self.untraced(&at, "water.sediment", "clouds are not traced");
            }
            let holes = water.get("holes").map(|holes| holes.alternatives(""));
            if holes
                .into_iter()
                .flatten()
                .any(|(_, holes)| holes.get("range_m").is_some())
            {
                let at = format!("{pointer}/holes");
                self.untraced(
                    &at,
                    "water.holes",
                    "a hole is open water, whatever range stands for it",
                );
            }
        }
    }

    fn untraced(&mut self, pointer: &str, field: &str, why: &str) {
        let message = format!("`{field}` does not go with the artifacts `truth` and `truth_report`: {why}");
        self.refuse(|| FieldError::new(pointer, message));
    }

    /// Of a picture only the renderer knows the size.
    fn truth_work(&mut self, document: &Node) {
        let scenes = places(document, "scene");
        if !scenes.iter().any(|(_, scene)| scene.get("family").is_some()) {
            return;
        }
        let asked = document.get("truth");
        let number = |name| asked.and_then(|truth| truth.get(name)).and_then(Node::greatest);
        let default = Truth::default();
        let truth = Truth {
            paths_max: number("paths_max").map_or(default.paths_max, |paths| paths as u64),
            budget_s: number("budget_s"),
            ..default
        };
        for (_, camera) in places(document, "camera") {
            let side = |name| camera.get(name).and_then(Node::greatest).unwrap_or_default();
            let wrong = truth.most_paths((side("width") * side("height")) as u64).err();
            if let Some(wrong) = wrong {
                let pointer = match wrong {
                    TooMuch::NeedsBudget { .. } if truth.paths_max == default.paths_max => "/camera",
                    TooMuch::NeedsBudget { .. } => "/truth/paths_max",
                    TooMuch::BudgetTooSmall { .. } => "/truth/budget_s",
                };
                self.refuse(|| FieldError::new(pointer, wrong.to_string()));
            }
        }
    }
}
