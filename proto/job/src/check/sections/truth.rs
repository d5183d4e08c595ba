//! Path budget of the Monte Carlo truth.

use crate::artifact::ArtifactKind;
use crate::check::present::Contents;
use crate::check::{Checker, find_values};
use crate::invalid::FieldError;
use crate::node::Node;
use crate::truth::{TooMuch, Truth};

/// Whether a frame can request the Monte Carlo truth.
pub(crate) fn is_traced(document: &Node) -> bool {
    let lists = find_values(document, "artifacts");
    let mut names = lists.iter().flat_map(|(pointer, list)| match list {
        Node::List(items) => items.iter().flat_map(|item| item.strings(pointer)).collect(),
        _ => Vec::new(),
    });
    names.any(|(_, name)| ArtifactKind::parse(name).is_some_and(|kind| kind.is_traced()))
}

impl Checker<'_> {
    /// Checks the paths of the largest frame. Only the renderer knows the size of an uploaded image.
    pub(crate) fn check_truth_work(&mut self, document: &Node, contents: &Contents<'_>) {
        if !is_traced(document) || !contents.has("scene.family", None) {
            return;
        }
        let [paths_max, budget_s] = ["paths_max", "budget_s"].map(|name| {
            let given = document.get("truth").and_then(|truth| truth.get(name));
            given.and_then(Node::greatest)
        });
        let default = Truth::default();
        let truth = Truth {
            paths_max: paths_max.map_or(default.paths_max, |paths| paths as u64),
            budget_s,
            ..default
        };
        for (_, camera) in find_values(document, "camera") {
            let [width, height] =
                ["width", "height"].map(|name| camera.get(name).and_then(Node::greatest).unwrap_or_default());
            if let Err(wrong) = truth.most_paths((width * height) as u64) {
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
