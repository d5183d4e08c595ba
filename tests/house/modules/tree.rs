//! The modules of a crate: their items, imports and paths.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::imports::{Import, read_imports};
use super::source::{block_end, is_word_character, read_code, words};

/// The names from the root of a crate to a module, or the segments of a path in a source.
pub(super) type Names = Vec<String>;

/// Keywords before the name of a type.
const TYPES: [&str; 5] = ["struct", "enum", "trait", "type", "union"];
/// Keywords before the name of a value.
const VALUES: [&str; 3] = ["fn", "const", "static"];

/// A module.
#[derive(Default)]
pub(super) struct Module {
    pub(super) children: BTreeSet<String>,
    pub(super) types: BTreeSet<String>,
    pub(super) values: BTreeSet<String>,
    pub(super) imports: Vec<Import>,
    /// Paths of at least two segments outside of imports.
    pub(super) paths: BTreeSet<Names>,
    /// All identifiers outside of imports.
    pub(super) words: BTreeSet<String>,
}

/// The modules of a crate by their names.
pub(super) struct Tree(pub(super) BTreeMap<Names, Module>);

impl Tree {
    /// Reads the crate of a source folder.
    pub(super) fn read(source: &Path) -> Self {
        let entries = ["lib.rs", "main.rs"].map(|name| source.join(name));
        let entry = entries.into_iter().find(|path| path.is_file());
        let mut tree = Self(BTreeMap::new());
        tree.add_file(&entry.expect("a crate has a root"), source, Names::new());
        tree
    }

    fn add_file(&mut self, file: &Path, folder: &Path, names: Names) {
        let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.add_module(&read_code(&text), folder, names);
    }

    /// Adds a module and those below it. `folder` holds the files of its children.
    fn add_module(&mut self, code: &str, folder: &Path, names: Names) {
        let mut module = Module::default();
        let mut own_code = String::new();
        let mut rest = code;
        while let Some(declaration) = find_declaration(rest) {
            own_code.push_str(&rest[..declaration.start]);
            rest = &rest[declaration.end..];
            if declaration.name == "tests" {
                continue;
            }
            let (below, child) = (folder.join(declaration.name), with_name(&names, declaration.name));
            module.children.insert(declaration.name.to_owned());
            match declaration.body {
                Some(body) => self.add_module(body, &below, child),
                None => {
                    // A file of another crate, under `#[path = …]`, has none.
                    if let Some(file) = find_file(&below) {
                        self.add_file(&file, &below, child);
                    }
                }
            }
        }
        own_code.push_str(rest);
        let code = read_imports(&own_code, &mut module.imports);
        read_items(&code, &mut module);
        module.words = words(&code).map(|(word, _)| word.to_owned()).collect();
        module.paths = read_paths(&code);
        self.0.insert(names, module);
    }
}

/// The names of a module and of something in it.
pub(super) fn with_name(names: &[String], name: &str) -> Names {
    let mut longer = names.to_vec();
    longer.push(name.to_owned());
    longer
}

fn find_file(below: &Path) -> Option<PathBuf> {
    let files = [below.with_extension("rs"), below.join("mod.rs")];
    files.into_iter().find(|file| file.is_file())
}

/// `mod name;` or `mod name { … }`.
struct Declaration<'a> {
    start: usize,
    end: usize,
    name: &'a str,
    body: Option<&'a str>,
}

fn find_declaration(code: &str) -> Option<Declaration<'_>> {
    let mut all = words(code).peekable();
    while let Some((word, after)) = all.next() {
        let Some((name, end)) = all.peek().copied().filter(|_| word == "mod") else {
            continue;
        };
        let rest = code[end..].trim_start();
        let mark = code.len() - rest.len();
        let start = after - "mod".len();
        if rest.starts_with(';') {
            let end = mark + 1;
            return Some(Declaration {
                start,
                end,
                name,
                body: None,
            });
        }
        if rest.starts_with('{') {
            let end = block_end(code, mark);
            let body = Some(&code[mark + 1..end - 1]);
            return Some(Declaration {
                start,
                end,
                name,
                body,
            });
        }
    }
    None
}

/// Adds the items that a module declares outside of blocks.
fn read_items(code: &str, module: &mut Module) {
    let mut flat = String::new();
    let mut rest = code;
    while let Some(open) = rest.find('{') {
        flat.push_str(&rest[..open]);
        flat.push(' ');
        rest = &rest[block_end(rest, open)..];
    }
    flat.push_str(rest);
    let mut previous = "";
    for (word, _) in words(&flat) {
        if word == "mut" || word == "fn" && previous == "const" {
            previous = word;
            continue;
        }
        if TYPES.contains(&previous) {
            module.types.insert(word.to_owned());
        } else if VALUES.contains(&previous) {
            module.values.insert(word.to_owned());
        }
        previous = word;
    }
}

fn read_paths(code: &str) -> BTreeSet<Names> {
    let mut paths = BTreeSet::new();
    let mut path = Names::new();
    let mut end = 0;
    for (word, after) in words(code) {
        let start = after - word.len();
        let joins = code[end..start].trim() == "::" && !path.is_empty();
        if !joins {
            keep_path(&mut paths, std::mem::take(&mut path));
            // `<T>::name`, and the variables of macros.
            let before = code[..start].trim_end();
            if before.ends_with("::") || before.ends_with('$') {
                end = after;
                continue;
            }
        }
        path.push(word.to_owned());
        end = after;
    }
    keep_path(&mut paths, path);
    paths
}

fn keep_path(paths: &mut BTreeSet<Names>, path: Names) {
    if path.len() > 1 && !path[0].starts_with(|c: char| !is_word_character(c)) {
        paths.insert(path);
    }
}
