//! Roles by the names of files and folders.

use std::collections::{BTreeMap, BTreeSet};

use super::entries::Entry;
use super::role::Role;
use super::words::{Vocabulary, split_numbered};

/// Whether any scene of a folder has a picture and something else by these words.
pub(super) fn has_pair(entries: &[Entry], vocabulary: &Vocabulary) -> bool {
    let mut roles: BTreeMap<String, BTreeSet<Role>> = BTreeMap::new();
    for Named { role, scene } in entries.iter().filter_map(|entry| find_named(entry, vocabulary)) {
        roles.entry(scene).or_default().insert(role);
    }
    roles
        .values()
        .any(|roles| roles.contains(&Role::Picture) && roles.len() > 1)
}

/// Role and scene of a name.
pub(super) struct Named {
    pub(super) role: Role,
    pub(super) scene: String,
}

/// Reads a role from the file's name, or else from the first folder that has one. The rest of the path is the scene.
pub(super) fn find_named(entry: &Entry, vocabulary: &Vocabulary) -> Option<Named> {
    let own = split_name(entry.stem(), vocabulary);
    let mut folders: Vec<&str> = entry
        .folder()
        .split('/')
        .filter(|folder| !folder.is_empty())
        .collect();
    let position = folders
        .iter()
        .position(|folder| vocabulary.find_role(folder).is_some());
    let folder_role = position.and_then(|position| vocabulary.find_role(folders.remove(position)));
    let (role, rest) = match (own, folder_role) {
        (Some((role, rest)), Some(folder_role)) if role == folder_role => (role, rest),
        // `rgb/depth_test_1.png` is a picture: the folder decides.
        (_, Some(role)) => (role, entry.stem()),
        (Some((role, rest)), None) => (role, rest),
        (None, None) => return None,
    };
    folders.push(rest);
    Some(Named {
        role,
        scene: folders.join("/"),
    })
}

/// The role of a name such as `depth_0001` or `0001_depth`, and the rest of the name.
fn split_name<'a>(stem: &'a str, vocabulary: &Vocabulary) -> Option<(Role, &'a str)> {
    if let Some((word, number)) = split_numbered(stem)
        && let Some(role) = vocabulary.find_role(word)
    {
        return Some((role, number));
    }
    let mut ends = stem.match_indices(['_', '-', '.']);
    ends.find_map(|(position, _)| {
        let role = vocabulary.find_role(&stem[position + 1..])?;
        (position > 0).then_some((role, &stem[..position]))
    })
}

/// Whether a file lists frames: `transforms.json`, or one of a part such as `transforms_train.json`.
pub(super) fn is_list(file_name: &str) -> bool {
    let part = file_name
        .strip_prefix("transforms")
        .and_then(|rest| rest.strip_suffix(".json"));
    part.is_some_and(|part| part.is_empty() || part.starts_with('_'))
}
