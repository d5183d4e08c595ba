//! Path budget of the Monte Carlo truth.

use super::present::Contents;
use super::{Checker, places};
use crate::artifact::ArtifactKind;
use crate::invalid::FieldError;
use crate::node::Node;
use crate::truth::{TooMuch, Truth};

/// Whether a frame can request the Monte Carlo truth.
pub(crate) fn is_traced(document: &Node) -> bool {
    let lists = places(document, "artifacts");
    let mut names = lists.iter().flat_map(|(pointer, list)| match list {
        Node::List(items) => items.iter().flat_map(|item| item.strings(pointer)).collect(),
        _ => Vec::new(),
    });
    names.any(|(_, name)| ArtifactKind::parse(name).is_some_and(|kind| kind.is_traced()))
}

impl Checker<'_> {
    /// Checks the paths of the largest frame. Only the renderer knows the size of an uploaded image.
    pub(super) fn truth_work(&mut self, document: &Node, contents: &Contents<'_>) {
        if !is_traced(document) || !contents.has("scene.family", None) {
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
