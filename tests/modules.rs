//! No cycles among the top-level modules of a crate: each can be read without its users.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use fathom_tests::root;

/// The top-level modules used by each.
type Uses = BTreeMap<String, BTreeSet<String>>;

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// A source without comments and without its trailing tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a readable source");
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The first names of a path or group of paths: `a` of `a::b`, `a` and `c` of `{a::{b, d}, c}`.
fn first_names(text: &str) -> Vec<&str> {
    let word = |text: &str| {
        text.find(|c: char| !c.is_alphanumeric() && c != '_')
            .unwrap_or(text.len())
    };
    let Some(group) = text.strip_prefix('{') else {
        return vec![&text[..word(text)]];
    };
    let (mut depth, mut begun, mut names) = (0, 0, Vec::new());
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                let part = group[begun..at].trim();
                names.push(&part[..word(part)]);
                begun = at + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    names
}

/// The top-level modules under their names and the names that the crate's root imports from them.
fn modules(root_code: &str) -> BTreeMap<String, String> {
    let declared = root_code.lines().filter_map(|line| {
        let (visibility, name) = line.split_once("mod ")?;
        let is_declaration = visibility.is_empty() || visibility.starts_with("pub");
        is_declaration.then(|| name.strip_suffix(';').map(str::to_owned))?
    });
    let mut names: BTreeMap<String, String> = declared.map(|name| (name.clone(), name)).collect();
    let plain = names.clone();
    for statement in root_code.split("use ").skip(1) {
        let statement = statement.split(';').next().unwrap_or_default();
        let Some((module, items)) = statement.trim_start_matches("crate::").split_once("::") else {
            continue;
        };
        if plain.contains_key(module) {
            let items = items.split(|c: char| !c.is_alphanumeric() && c != '_');
            names.extend(
                items
                    .filter(|item| !item.is_empty())
                    .map(|item| (item.to_owned(), module.to_owned())),
            );
        }
    }
    names.extend(plain);
    names
}

fn uses(source: &Path) -> Uses {
    let entry = ["lib.rs", "main.rs"]
        .map(|name| source.join(name))
        .into_iter()
        .find(|path| path.is_file());
    let entry = entry.expect("a crate has a root");
    let known = modules(&code(&entry));
    let mut files = Vec::new();
    sources(source, &mut files);
    let mut uses = Uses::new();
    for file in files.iter().filter(|file| **file != entry) {
        let place = file
            .strip_prefix(source)
            .expect("a file of the crate")
            .with_extension("");
        let mut parts: Vec<&str> = place.iter().filter_map(|part| part.to_str()).collect();
        if parts.last() == Some(&"mod") {
            parts.pop();
        }
        if !known.contains_key(parts[0]) || parts.contains(&"tests") {
            continue;
        }
        let text = code(file);
        for prefix in ["crate::".to_owned(), "super::".repeat(parts.len())] {
            for (at, _) in text.match_indices(&prefix) {
                let is_whole = !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
                let used = first_names(&text[at + prefix.len()..])
                    .into_iter()
                    .filter_map(|name| known.get(name));
                if is_whole {
                    uses.entry(parts[0].to_owned())
                        .or_default()
                        .extend(used.filter(|name| *name != parts[0]).cloned());
                }
            }
        }
    }
    uses
}

fn reached(uses: &Uses, from: &str) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from.to_owned()];
    while let Some(name) = open.pop() {
        let next = uses.get(&name).into_iter().flatten();
        open.extend(
            next.filter(|name| seen.insert((*name).clone()))
                .cloned()
                .collect::<Vec<_>>(),
        );
    }
    seen
}

/// Groups of modules that reach each other.
fn circles(uses: &Uses) -> BTreeSet<BTreeSet<String>> {
    let all: BTreeMap<&String, BTreeSet<String>> =
        uses.keys().map(|name| (name, reached(uses, name))).collect();
    let back = |name: &String| {
        let both = all[name]
            .iter()
            .filter(|other| all.get(other).is_some_and(|there| there.contains(name)));
        both.cloned().collect::<BTreeSet<String>>()
    };
    all.keys()
        .map(|name| back(name))
        .filter(|circle| circle.len() > 1)
        .collect()
}

#[test]
fn no_crate_has_a_circle_among_its_top_level_modules() {
    let manifest: toml::Table = fs::read_to_string(root().join("Cargo.toml"))
        .expect("a manifest")
        .parse()
        .expect("TOML");
    let members = manifest["workspace"]["members"].as_array().expect("an array");
    let mut found = BTreeSet::new();
    for member in members.iter().filter_map(toml::Value::as_str) {
        let uses = uses(&root().join(member).join("src"));
        found.extend(
            circles(&uses)
                .into_iter()
                .map(|circle| (member.to_owned(), circle)),
        );
    }
    assert!(found.is_empty(), "these modules use each other: {found:#?}");
}

#[test]
fn a_circle_through_groups_and_names_of_the_root_is_found() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write =
        |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a writable folder");
    write(
        "lib.rs",
        "mod a;\npub mod b;\nmod c;\nmod d;\npub use c::{Third as Renamed, third};\n",
    );
    write("a.rs", "use crate::{d::{x, y}, b};\n");
    write("b.rs", "fn f() { super::third() }\n");
    write(
        "c.rs",
        "// use crate::d;\nuse crate::a::Thing;\n#[cfg(test)]\nmod tests {\n use crate::d;\n}\n",
    );
    write("d.rs", "use std::crate_::a;\n");
    let expected = ["a", "b", "c"].map(str::to_owned).into_iter().collect();
    assert_eq!(circles(&uses(folder.path())), BTreeSet::from([expected]));
}
