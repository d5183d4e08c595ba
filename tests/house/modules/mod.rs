//! No cycles among the modules of a crate at any depth: each can be read without its users.

mod cycles;
mod imports;
mod resolve;
pub(crate) mod source;
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use fathom_tests::root;

use cycles::find_cycles;
use tree::Tree;

/// Whether a cycle is an exception.
fn is_known(cycle: &BTreeSet<String>) -> bool {
    cycle.iter().all(|module| module.starts_with("crate::lamp::"))
}

#[test]
fn no_crate_has_a_cycle_among_its_modules() {
    let manifest: toml::Table = fs::read_to_string(root().join("Cargo.toml"))
        .expect("a manifest")
        .parse()
        .expect("TOML");
    let members = manifest["workspace"]["members"].as_array().expect("an array");
    let mut found = BTreeSet::new();
    for member in members.iter().filter_map(toml::Value::as_str) {
        let cycles = find_cycles(&Tree::read(&root().join(member).join("src")));
        let cycles = cycles.into_iter().map(|cycle| (member.to_owned(), cycle));
        found.extend(cycles.filter(|(_, cycle)| !is_known(cycle)));
    }
    assert!(found.is_empty(), "these modules use each other: {found:#?}");
}

/// The cycles of a crate with these files.
fn cycles_of(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        let file = folder.path().join(name);
        fs::create_dir_all(file.parent().unwrap_or(Path::new(""))).expect("a writable folder");
        fs::write(file, text).expect("a writable folder");
    }
    let cycles = find_cycles(&Tree::read(folder.path()));
    cycles
        .into_iter()
        .map(|cycle| cycle.into_iter().collect())
        .collect()
}

#[test]
fn a_cycle_through_groups_and_names_of_the_root_is_found() {
    let found = cycles_of(&[
        (
            "lib.rs",
            "mod a;\npub mod b;\nmod c;\nmod d;\npub use c::{Third as Renamed, third};\n",
        ),
        ("a.rs", "use crate::{d::{x, y}, b::f};\npub struct Thing;\n"),
        ("b.rs", "pub fn f() { super::third() }\n"),
        (
            "c.rs",
            "// use crate::d;\nuse crate::a::Thing;\npub fn third() {}\n#[cfg(test)]\nmod tests {\n use crate::d;\n}\n",
        ),
        (
            "d.rs",
            "use std::crate_::a;\nconst TEXT: &str = \"crate::a::Thing\";\npub fn x() {}\n",
        ),
    ]);
    assert_eq!(found, [["crate::a", "crate::b", "crate::c"]]);
}

#[test]
fn a_cycle_below_the_top_level_is_found() {
    let files = [
        ("lib.rs", "mod top;\n"),
        ("top.rs", "mod left;\nmod right;\npub use left::Left;\n"),
        (
            "top/left.rs",
            "pub struct Left;\nfn f() { super::right::run::<'_, 'x'>() }\n",
        ),
        ("top/right/mod.rs", "mod inner;\npub fn run() {}\n"),
        ("top/right/inner.rs", "use crate::top::Left;\n"),
    ];
    assert_eq!(cycles_of(&files), [["crate::top::left", "crate::top::right"]]);
    assert!(cycles_of(&[&files[..4], &[("top/right/inner.rs", "")]].concat()).is_empty());
}

#[test]
fn a_child_that_uses_its_user_is_found() {
    let child = (
        "parent/child.rs",
        "use super::Options;\npub fn run(options: &Options) {}\n",
    );
    let uses = (
        "parent.rs",
        "mod child;\npub struct Options;\nfn f() { child::run(&Options) }\n",
    );
    let exports = (
        "parent.rs",
        "mod child;\npub use child::run;\npub struct Options;\n",
    );
    let root = ("lib.rs", "mod parent;\n");
    assert_eq!(
        cycles_of(&[root, uses, child]),
        [["crate::parent", "crate::parent::child"]]
    );
    assert!(cycles_of(&[root, exports, child]).is_empty());
}
