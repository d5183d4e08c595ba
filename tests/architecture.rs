//! The house rules that a manifest or a source file can show.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use fathom_tests::root;

/// Every crate and the crates of ours that it may use. A crate that is missing here fails the test, and so does an
/// arrow that is not listed: read ARCHITECTURE.md before you add one.
const ARROWS: &[(&str, &[&str])] = &[
    ("workers/imaging", &[]),
    ("workers/optics", &["imaging"]),
    ("workers/scenes", &["imaging"]),
    ("workers/enhance", &["imaging"]),
    ("workers/quality", &["imaging"]),
    ("workers/style", &["imaging"]),
    ("workers/fidelity", &["enhance", "imaging", "optics", "quality"]),
    ("workers/training", &["imaging", "scenes", "style"]),
    ("services/spec", &["imaging", "optics"]),
    ("proto", &["spec"]),
    ("services/faults", &[]),
    ("services/store", &["faults"]),
    ("services/catalogue", &["faults", "spec"]),
    (
        "workers/renderer",
        &[
            "enhance", "faults", "imaging", "optics", "proto", "quality", "scenes", "spec", "style",
        ],
    ),
    (
        "services/api",
        &[
            "catalogue",
            "enhance",
            "faults",
            "imaging",
            "optics",
            "proto",
            "quality",
            "renderer",
            "scenes",
            "spec",
            "store",
            "style",
        ],
    ),
    (
        "services/cli",
        &[
            "api",
            "catalogue",
            "enhance",
            "faults",
            "fidelity",
            "imaging",
            "optics",
            "proto",
            "quality",
            "renderer",
            "scenes",
            "spec",
            "store",
            "style",
            "training",
        ],
    ),
    ("tests", &[]),
];

/// Crates that are values in, values out.
const PURE: &[&str] = &[
    "workers/imaging",
    "workers/optics",
    "workers/scenes",
    "workers/enhance",
    "workers/quality",
    "workers/training",
    "services/spec",
];

/// What a pure crate must not name: files, sockets, clock, environment, processes, logging, an async runtime.
const IMPURE: &[&str] = &[
    "std::fs",
    "std::net",
    "std::env",
    "std::process",
    "io::stdin",
    "io::stdout",
    "io::stderr",
    "SystemTime",
    "Instant::now",
    "tokio",
    "tracing",
    "println!",
    "eprintln!",
    "thread_rng",
    "rand::",
];

fn manifest(folder: &str) -> toml::Table {
    let path = root().join(folder).join("Cargo.toml");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.parse()
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn dependencies(manifest: &toml::Table, section: &str) -> BTreeSet<String> {
    let table = manifest.get(section).and_then(toml::Value::as_table);
    table
        .map(|table| table.keys().cloned().collect())
        .unwrap_or_default()
}

fn ours() -> BTreeSet<String> {
    let workspace = manifest("");
    let all = workspace["workspace"]["dependencies"]
        .as_table()
        .expect("a table")
        .clone();
    all.into_iter()
        .filter(|(_, value)| value.get("path").is_some())
        .map(|(name, _)| name)
        .collect()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

#[test]
fn every_member_is_in_the_table_of_arrows_and_uses_only_what_it_may() {
    let members: BTreeSet<String> = manifest("")["workspace"]["members"]
        .as_array()
        .expect("an array")
        .iter()
        .map(|member| member.as_str().expect("a path").to_owned())
        .collect();
    let listed: BTreeSet<String> = ARROWS.iter().map(|(folder, _)| (*folder).to_owned()).collect();
    assert_eq!(members, listed);
    let ours = ours();
    for (folder, allowed) in ARROWS {
        let used: BTreeSet<_> = dependencies(&manifest(folder), "dependencies");
        for name in used.intersection(&ours) {
            assert!(
                allowed.contains(&name.as_str()),
                "{folder} must not depend on {name}"
            );
        }
    }
}

#[test]
fn a_restoration_never_sees_the_water_that_it_is_judged_by() {
    let ours = ours();
    let table: BTreeMap<&str, &[&str]> = ARROWS
        .iter()
        .map(|(folder, arrows)| (folder.rsplit('/').next().unwrap_or(folder), *arrows))
        .collect();
    for start in ["enhance", "quality"] {
        let mut seen = BTreeSet::from([start.to_owned()]);
        let mut open = vec![start.to_owned()];
        while let Some(name) = open.pop() {
            let folder = ARROWS
                .iter()
                .map(|(folder, _)| *folder)
                .find(|f| f.ends_with(&format!("/{name}")));
            for next in
                dependencies(&manifest(folder.expect("a listed crate")), "dependencies").intersection(&ours)
            {
                assert!(table.contains_key(next.as_str()));
                if seen.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        assert!(
            !seen.contains("optics"),
            "{start} reaches optics through {seen:?}"
        );
    }
}

#[test]
fn pure_crates_name_no_file_socket_clock_environment_or_log() {
    for folder in PURE {
        for path in sources(&root().join(folder).join("src")) {
            let text = fs::read_to_string(&path).expect("a readable source");
            for word in IMPURE {
                assert!(!text.contains(word), "{} names {word}", path.display());
            }
        }
    }
}

#[test]
fn sql_is_spoken_only_by_the_catalogue_and_the_artifact_packs() {
    for (folder, _) in ARROWS {
        let speaks = dependencies(&manifest(folder), "dependencies").contains("sqlx");
        assert_eq!(
            speaks,
            matches!(*folder, "services/catalogue" | "services/store"),
            "{folder}"
        );
    }
}

#[test]
fn every_crate_keeps_the_workspace_lints_and_unsafe_is_forbidden() {
    let lints = &manifest("")["workspace"]["lints"];
    assert_eq!(lints["rust"]["unsafe_code"].as_str(), Some("forbid"));
    for (folder, _) in ARROWS {
        assert_eq!(
            manifest(folder)["lints"]["workspace"].as_bool(),
            Some(true),
            "{folder}"
        );
    }
}

#[test]
fn no_source_file_outgrows_four_hundred_lines() {
    for (folder, _) in ARROWS {
        for path in sources(&root().join(folder)) {
            let lines = fs::read_to_string(&path)
                .expect("a readable source")
                .lines()
                .count();
            assert!(
                lines <= 400,
                "{} has {lines} lines: is there a second topic in it?",
                path.display()
            );
        }
    }
}
