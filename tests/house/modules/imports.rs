//! `use` declarations.

use super::source::words;
use super::tree::Names;

/// A name that a `use` declaration imports.
pub(super) struct Import {
    pub(super) path: Names,
    /// Its name in the module; `*` for all names.
    pub(super) name: String,
    pub(super) is_public: bool,
}

/// Reads the imports of a module; returns its code without them.
pub(super) fn read_imports(code: &str, imports: &mut Vec<Import>) -> String {
    let mut kept = String::new();
    let mut copied = 0;
    for (word, after) in words(code) {
        let is_import = word == "use" && after >= copied && code[after..].starts_with(char::is_whitespace);
        let Some(length) = code[after..].find(';').filter(|_| is_import) else {
            continue;
        };
        let before = &code[copied..after - word.len()];
        let statement = before.rsplit([';', '}', '{']).next().unwrap_or_default();
        let is_public = words(statement).any(|(word, _)| word == "pub");
        read_tree(&code[after..after + length], &Names::new(), is_public, imports);
        kept.push_str(before);
        copied = after + length + 1;
    }
    kept.push_str(&code[copied..]);
    kept
}

/// Adds the leaves of a tree such as `a::{b, c::{self, d as e}}`.
fn read_tree(tree: &str, parents: &[String], is_public: bool, imports: &mut Vec<Import>) {
    let (head, group) = match tree.split_once('{') {
        Some((head, group)) => (head, group.trim_end().strip_suffix('}')),
        None => (tree, None),
    };
    let (head, alias) = match head.split_once(" as ") {
        Some((head, alias)) => (head, Some(alias.trim())),
        None => (head, None),
    };
    let mut path = parents.to_vec();
    let segments = head.split("::").map(str::trim);
    path.extend(segments.filter(|segment| !segment.is_empty()).map(str::to_owned));
    if let Some(group) = group {
        for part in split_group(group) {
            read_tree(part, &path, is_public, imports);
        }
        return;
    }
    if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
        path.pop();
    }
    if let Some(last) = path.last() {
        let name = alias.unwrap_or(last).to_owned();
        imports.push(Import {
            path,
            name,
            is_public,
        });
    }
}

/// The parts of a group between the commas outside of inner groups.
fn split_group(group: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (index, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&group[start..index]);
                start = index + 1;
            }
            _ => {}
        }
    }
    parts.push(&group[start..]);
    parts
}
