//! House rules checked on manifests and sources.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use fathom_tests::root;

use crate::modules::source::read_code;

/// After this line ARCHITECTURE.md lists every crate with the workspace crates that it uses.
const ARROWS_FOLLOW: &str = "compares this list with the manifests";
/// After this heading it lists every folder.
const MAP_FOLLOWS: &str = "## Map";

/// Crates without side effects.
const PURE: &[&str] = &[
    "workers/imaging",
    "workers/optics",
    "workers/camera",
    "workers/scenes",
    "workers/enhance",
    "workers/quality",
    "workers/training",
    "workers/truth",
    "proto/job",
];

/// Forbidden in pure crates outside of tests: files, sockets, clock, environment, processes, logging, an async runtime.
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

/// The folders of the workspace's members.
fn members() -> Vec<String> {
    let workspace = manifest("");
    let members = workspace["workspace"]["members"].as_array().expect("an array");
    members
        .iter()
        .map(|member| member.as_str().expect("a path").to_owned())
        .collect()
}

/// Each crate with its workspace dependencies, from the manifests.
fn arrows() -> BTreeMap<String, BTreeSet<String>> {
    let ours = ours();
    let arrows = |folder: &String| {
        let manifest = manifest(folder);
        let name = manifest["package"]["name"].as_str().expect("a name").to_owned();
        let used = dependencies(&manifest, "dependencies");
        (name, used.intersection(&ours).cloned().collect())
    };
    let folders = members();
    let product = folders.iter().filter(|folder| *folder != "tests");
    product.map(arrows).collect()
}

/// The lines of the first fenced block of ARCHITECTURE.md after this text.
fn block(behind: &str) -> Vec<String> {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let rest = page
        .split_once(behind)
        .expect("the text stands in ARCHITECTURE.md")
        .1;
    let lines = rest.lines().skip_while(|line| !line.starts_with("```")).skip(1);
    lines
        .take_while(|line| !line.starts_with("```"))
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_arrows_of_the_architecture_page_are_those_of_the_manifests() {
    let line = |(name, used): (String, BTreeSet<String>)| {
        let used: Vec<String> = used.into_iter().collect();
        format!("{name} → {}", used.join(", "))
            .trim_end_matches(" → ")
            .to_owned()
    };
    let expected: BTreeSet<String> = arrows().into_iter().map(line).collect();
    let written: BTreeSet<String> = block(ARROWS_FOLLOW).into_iter().collect();
    let missing: Vec<_> = expected.difference(&written).collect();
    let wrong: Vec<_> = written.difference(&expected).collect();
    assert!(
        missing.is_empty() && wrong.is_empty(),
        "ARCHITECTURE.md should say {missing:#?} and not {wrong:#?}"
    );
}

#[test]
fn the_map_of_the_architecture_page_has_every_member_and_every_folder_of_it_exists() {
    let mut parent = String::new();
    let mut folders = BTreeSet::new();
    for line in block(MAP_FOLLOWS).iter().filter(|line| !line.is_empty()) {
        let name = line.split_whitespace().next().unwrap_or_default();
        let is_below = line.starts_with(' ');
        if !is_below {
            name.clone_into(&mut parent);
        }
        let folder = if is_below {
            format!("{parent}{name}")
        } else {
            name.to_owned()
        };
        assert!(
            root().join(&folder).is_dir(),
            "the map has {folder}, which is not there"
        );
        folders.insert(folder.trim_end_matches('/').to_owned());
    }
    for member in members() {
        assert!(folders.contains(&member), "{member} is not in the map");
    }
}

#[test]
fn a_restoration_never_sees_the_water_that_it_is_judged_by() {
    let arrows = arrows();
    for start in ["enhance", "quality"] {
        let mut seen = BTreeSet::new();
        let mut open = vec![start.to_owned()];
        while let Some(name) = open.pop() {
            open.extend(
                arrows[&name]
                    .iter()
                    .filter(|next| seen.insert((*next).clone()))
                    .cloned(),
            );
        }
        assert!(
            !seen.contains("optics"),
            "{start} reaches optics through {seen:?}"
        );
    }
}

#[test]
fn workers_and_the_contract_never_depend_on_services() {
    let paths = &manifest("")["workspace"]["dependencies"];
    for folder in members() {
        if !["workers/", "proto/"]
            .iter()
            .any(|group| folder.starts_with(group))
        {
            continue;
        }
        let manifest = manifest(&folder);
        let mut used = dependencies(&manifest, "dependencies");
        used.extend(dependencies(&manifest, "dev-dependencies"));
        for name in used {
            let path = paths.get(&name).and_then(|dependency| dependency.get("path"));
            let is_service = path
                .and_then(toml::Value::as_str)
                .is_some_and(|path| path.starts_with("services/"));
            assert!(!is_service, "{folder} depends on {name}, a crate of services/");
        }
    }
}

#[test]
fn pure_crates_name_no_file_socket_clock_environment_or_log() {
    for folder in PURE {
        for path in sources(&root().join(folder).join("src")) {
            let text = read_code(&fs::read_to_string(&path).expect("a readable source"));
            for word in IMPURE {
                // `FournierForand::` is not a random generator.
                let mut found = text
                    .match_indices(word)
                    .map(|(at, _)| text[..at].chars().next_back());
                let whole = found.any(|before| !before.is_some_and(char::is_alphanumeric));
                assert!(!whole, "{} names {word}", path.display());
            }
        }
    }
}

#[test]
fn sql_is_spoken_only_by_the_catalogue_and_the_artifact_packs() {
    for folder in members() {
        let speaks = dependencies(&manifest(&folder), "dependencies").contains("sqlx");
        assert_eq!(
            speaks,
            matches!(folder.as_str(), "services/catalogue" | "services/store"),
            "{folder}"
        );
    }
}

#[test]
fn every_crate_keeps_the_workspace_lints_and_unsafe_is_forbidden() {
    let lints = &manifest("")["workspace"]["lints"];
    assert_eq!(lints["rust"]["unsafe_code"].as_str(), Some("forbid"));
    for folder in members() {
        assert_eq!(
            manifest(&folder)["lints"]["workspace"].as_bool(),
            Some(true),
            "{folder}"
        );
    }
}

#[test]
fn no_source_file_outgrows_four_hundred_lines() {
    for folder in members() {
        for path in sources(&root().join(&folder)) {
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
