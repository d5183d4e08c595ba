//! Groups of modules that reach each other.

use std::collections::{BTreeMap, BTreeSet};

use super::resolve::Arrow;
use super::tree::{Names, Tree};

/// The neighbors used by each module at one level.
type Uses = BTreeMap<Names, BTreeSet<Names>>;

/// The cycles of a crate at every level: children of one module that use each other, also through the items that the
/// module itself declares. Modules are written as paths.
pub(super) fn find_cycles(tree: &Tree) -> BTreeSet<BTreeSet<String>> {
    let mut levels: BTreeMap<Names, Uses> = BTreeMap::new();
    for user in tree.0.keys() {
        for used in tree.used_modules(user) {
            let arrow = Arrow::new(user, &used);
            let uses = levels.entry(arrow.level).or_default();
            uses.entry(arrow.user).or_default().insert(arrow.used);
        }
    }
    levels.values().flat_map(find_groups).collect()
}

fn find_groups(uses: &Uses) -> BTreeSet<BTreeSet<String>> {
    let reached: BTreeMap<&Names, BTreeSet<Names>> =
        uses.keys().map(|name| (name, find_reached(uses, name))).collect();
    let mut groups = BTreeSet::new();
    for (name, others) in &reached {
        let both = others
            .iter()
            .filter(|other| reached.get(other).is_some_and(|back| back.contains(*name)));
        let group: BTreeSet<String> = both.map(|module| write_path(module)).collect();
        if group.len() > 1 {
            groups.insert(group);
        }
    }
    groups
}

fn find_reached(uses: &Uses, from: &Names) -> BTreeSet<Names> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    while let Some(name) = open.pop() {
        for next in uses.get(name).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next);
            }
        }
    }
    seen
}

fn write_path(names: &[String]) -> String {
    let mut path = String::from("crate");
    for name in names {
        path.push_str("::");
        path.push_str(name);
    }
    path
}
