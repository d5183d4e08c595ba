//! Markdown refers to existing files, headings, commands, options, packages, tests and benches only.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use fathom_tests::{fathom, root};

/// Folders without pages of this repository, by their names.
const SKIPPED: [&str; 5] = ["target", ".git", "out", ".onnxruntime", ".schemathesis"];
/// Data of a service, below the root.
const DATA: &str = "data";
/// Largest picture of the documentation; charts may be larger, as they are text.
const PICTURE_BYTES: u64 = 150_000;

struct Page {
    path: PathBuf,
    text: String,
}

/// A span between backticks, or a line of a fenced block.
struct Code<'a> {
    text: &'a str,
    is_fenced: bool,
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if path.is_dir() && !SKIPPED.contains(&name.as_str()) && path != root().join(DATA) {
            files(&path, found);
        } else if path.is_file() {
            found.push(path);
        }
    }
}

fn all_files() -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(&root(), &mut found);
    found
}

fn pages(files: &[PathBuf]) -> Vec<Page> {
    let pages = files
        .iter()
        .filter(|path| path.extension().is_some_and(|end| end == "md"));
    let read = |path: &PathBuf| Page {
        text: fs::read_to_string(path).expect("a readable page"),
        path: path.clone(),
    };
    pages.map(read).collect()
}

fn code(page: &Page) -> Vec<Code<'_>> {
    let mut found = Vec::new();
    let mut is_fenced = false;
    for line in page.text.lines() {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        } else if is_fenced {
            found.push(Code {
                text: line,
                is_fenced,
            });
        } else {
            let spans = line.split('`').skip(1).step_by(2);
            found.extend(spans.map(|text| Code { text, is_fenced }));
        }
    }
    found
}

/// Targets of links within the repository, with their fragments.
fn links(page: &Page) -> impl Iterator<Item = &str> {
    let prose = page.text.lines().flat_map(|line| line.split('`').step_by(2));
    let targets = prose
        .flat_map(|text| text.split("](").skip(1))
        .filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://"))
}

/// Fragments of the headings of a page, as GitHub derives them.
fn fragments(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let derive = |heading: &str| {
        let heading = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = heading
            .chars()
            .filter(|c| c.is_alphanumeric() || "-_ ".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(derive).collect()
}

/// Whether a link leads to a file and, if it has a fragment, to a heading of it.
fn leads_somewhere(page: &Page, link: &str) -> bool {
    let (file, fragment) = link.split_once('#').unwrap_or((link, ""));
    let folder = page.path.parent().expect("a page has a folder");
    let target = if file.is_empty() {
        page.path.clone()
    } else {
        folder.join(file)
    };
    let has_heading = |fragment: &str| {
        let text = fs::read_to_string(&target).unwrap_or_default();
        fragments(&text).contains(fragment)
    };
    target.exists() && (fragment.is_empty() || has_heading(fragment))
}

#[test]
fn every_link_leads_to_a_file_and_heading() {
    let mut dead = Vec::new();
    let mut seen = 0;
    for page in pages(&all_files()) {
        seen += links(&page).count();
        let broken = links(&page).filter(|link| !leads_somewhere(&page, link));
        dead.extend(broken.map(|link| format!("{}: {link}", page.path.display())));
    }
    assert!(seen > 20, "only {seen} links were found");
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

#[test]
fn the_index_of_the_documentation_links_every_page() {
    let docs = root().join("docs");
    let index = fs::read_to_string(docs.join("README.md")).expect("an index");
    let all = all_files();
    let of_docs = all.iter().filter_map(|path| path.strip_prefix(&docs).ok());
    let listed: Vec<String> = of_docs
        .filter(|path| path.extension().is_some_and(|end| end == "md") && *path != Path::new("README.md"))
        .map(|path| path.display().to_string())
        .collect();
    assert!(listed.len() > 20, "only {} pages", listed.len());
    let missing: Vec<_> = listed
        .iter()
        .filter(|path| !index.contains(&format!("({path})")))
        .collect();
    assert!(missing.is_empty(), "docs/README.md does not link {missing:?}");
}

#[test]
fn pictures_of_the_documentation_are_small_and_shown() {
    let all = all_files();
    let text: String = pages(&all).into_iter().map(|page| page.text).collect();
    let kind = |path: &PathBuf| path.extension().map(|end| end.to_string_lossy().into_owned());
    let pictures = all
        .iter()
        .filter(|path| path.starts_with(root().join("docs")))
        .filter_map(|path| Some((path, kind(path)?)))
        .filter(|(_, kind)| ["png", "jpg", "webp", "svg"].contains(&kind.as_str()));
    let mut seen = 0;
    for (path, kind) in pictures {
        seen += 1;
        let bytes = fs::metadata(path).expect("a readable file").len();
        let name = path.file_name().expect("a name").to_string_lossy();
        assert!(
            kind == "svg" || (kind == "webp" && bytes <= PICTURE_BYTES),
            "{} has {bytes} bytes; write it with scripts/write_webp.py",
            path.display()
        );
        assert!(text.contains(&*name), "no page shows {}", path.display());
    }
    assert!(seen > 20, "only {seen} pictures");
}

/// Whether a word of code looks like a path of the repository. Names without a folder are ambiguous and pass.
fn names_a_file(word: &str, top: &BTreeSet<String>) -> bool {
    let is_plain = word
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "._-/".contains(c));
    let is_ours = word.split_once('/').is_some_and(|(first, _)| top.contains(first));
    is_plain && (is_ours || word.ends_with(".rs"))
}

#[test]
fn every_path_in_code_is_a_file_of_the_repository() {
    let all = all_files();
    let base = root();
    let relative: Vec<String> = all
        .iter()
        .filter_map(|path| Some(format!("/{}", path.strip_prefix(&base).ok()?.display())))
        .collect();
    let top: BTreeSet<String> = relative
        .iter()
        .filter_map(|path| Some(path.strip_prefix('/')?.split_once('/')?.0.to_owned()))
        .collect();
    let mut missing = Vec::new();
    for page in pages(&all) {
        for word in code(&page).iter().flat_map(|code| code.text.split_whitespace()) {
            let word = word
                .trim_matches(|c: char| "'\"(),;:".contains(c))
                .trim_end_matches('/');
            let ending = format!("/{word}");
            let exists = base.join(word).exists() || relative.iter().any(|path| path.ends_with(&ending));
            if names_a_file(word, &top) && !exists {
                missing.push(format!("{}: {word}", page.path.display()));
            }
        }
    }
    assert!(missing.is_empty(), "missing paths:\n{}", missing.join("\n"));
}

/// Commands of a binary, such as `bench render`, each with its options.
type Commands = BTreeMap<String, BTreeSet<String>>;

fn read_help(binary: &Path, command: &[String], found: &mut Commands) {
    let output = Command::new(binary)
        .args(command)
        .arg("--help")
        .output()
        .expect("the binary starts");
    let text = String::from_utf8(output.stdout).expect("text");
    let mut section = "";
    let mut options = BTreeSet::new();
    for line in text.lines() {
        if !line.is_empty() && !line.starts_with(' ') {
            section = line;
        }
        let words: Vec<&str> = line
            .split_whitespace()
            .map(|word| word.trim_end_matches(','))
            .collect();
        match section {
            "Options:" => options.extend(
                words
                    .iter()
                    .take(2)
                    .filter(|w| w.starts_with('-'))
                    .map(|w| (*w).to_owned()),
            ),
            _ if section.to_lowercase().ends_with("commands:")
                && line.starts_with("  ")
                && !line.starts_with("   ")
                && words[0] != "help" =>
            {
                let below: Vec<String> = command.iter().cloned().chain([words[0].to_owned()]).collect();
                read_help(binary, &below, found);
            }
            _ => {}
        }
    }
    found.insert(command.join(" "), options);
}

/// Commands of each binary that pages may name.
fn binaries() -> BTreeMap<&'static str, Commands> {
    let mut found = BTreeMap::new();
    for (name, path) in [
        ("fathom", fathom()),
        ("fathom-lab", fathom().with_file_name("fathom-lab")),
    ] {
        if path.is_file() {
            let commands = found.entry(name).or_default();
            read_help(&path, &[], commands);
        }
    }
    found
}

/// Describes the mistake in a call of `fathom` or `fathom-lab`; `None` for other words.
fn wrong_call(words: &[&str], binaries: &BTreeMap<&str, Commands>) -> Option<String> {
    let name = words.first()?.trim_start_matches("target/release/");
    if !matches!(name, "fathom" | "fathom-lab") || words.len() < 2 {
        return None;
    }
    let Some(commands) = binaries.get(name) else {
        return Some(format!("there is no `{name}`"));
    };
    let ends = words
        .iter()
        .position(|word| ["|", "&", "#", ">", "&&", "\\"].contains(word));
    let words = &words[1..ends.unwrap_or(words.len())];
    let command = (1..=2.min(words.len()))
        .rev()
        .map(|count| words[..count].join(" "))
        .find(|name| commands.contains_key(name));
    let Some(command) = command else {
        let is_option = words.first().is_none_or(|word| word.starts_with('-'));
        return (!is_option).then(|| format!("`{name}` has no command {:?}", words[0]));
    };
    let known = &commands[&command];
    let option = |word: &&str| {
        word.split('=')
            .next()
            .unwrap_or_default()
            .trim_end_matches([':', ',', ')', ']'])
            .to_owned()
    };
    let unknown = words
        .iter()
        .map(option)
        .find(|word| word.starts_with("--") && word.len() > 2 && !known.contains(word));
    unknown.map(|option| format!("`{name} {command}` has no option {option}"))
}

#[test]
fn every_call_of_our_binaries_has_a_command_and_options_that_exist() {
    let binaries = binaries();
    let mut wrong = Vec::new();
    let mut seen = 0;
    for page in pages(&all_files()) {
        for code in code(&page) {
            let mut words: Vec<&str> = code.text.split_whitespace().collect();
            while words
                .first()
                .is_some_and(|word| word.contains('=') || *word == "$")
            {
                words.remove(0);
            }
            seen += usize::from(words.first().is_some_and(|word| word.ends_with("fathom")));
            if let Some(what) = wrong_call(&words, &binaries) {
                wrong.push(format!(
                    "{}: {what} in `{}`",
                    page.path.display(),
                    code.text.trim()
                ));
            }
        }
    }
    assert!(seen > 20, "only {seen} calls were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The folder of each package.
fn packages(files: &[PathBuf]) -> BTreeMap<String, PathBuf> {
    let manifests = files.iter().filter(|path| path.ends_with("Cargo.toml"));
    let named = manifests.filter_map(|path| {
        let manifest: toml::Table = fs::read_to_string(path).ok()?.parse().ok()?;
        let name = manifest.get("package")?.get("name")?.as_str()?.to_owned();
        Some((name, path.parent()?.to_owned()))
    });
    named.collect()
}

/// Describes the mistake in a call of cargo: an unknown package, test, bench or example.
fn wrong_cargo(words: &[&str], packages: &BTreeMap<String, PathBuf>) -> Option<String> {
    let after = |option: &str| {
        words
            .iter()
            .position(|word| *word == option)
            .and_then(|at| words.get(at + 1))
    };
    let folders: Vec<&PathBuf> = match after("-p").or_else(|| after("--package")) {
        Some(name) => match packages.get(*name) {
            Some(folder) => vec![folder],
            None => return Some(format!("there is no package {name}")),
        },
        None => packages.values().collect(),
    };
    for (option, place) in [
        ("--test", "tests"),
        ("--bench", "benches"),
        ("--example", "examples"),
    ] {
        if let Some(name) = after(option) {
            let exists = |folder: &&PathBuf| {
                let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
                manifest.contains(&format!("name = \"{name}\""))
                    || folder.join(place).join(format!("{name}.rs")).is_file()
                    || folder.join(place).join(name).join("main.rs").is_file()
            };
            if !folders.iter().any(exists) {
                return Some(format!("there is no {} {name}", &option[2..]));
            }
        }
    }
    None
}

#[test]
fn every_call_of_cargo_names_packages_tests_benches_and_examples_that_exist() {
    let all = all_files();
    let packages = packages(&all);
    let mut wrong = Vec::new();
    for page in pages(&all) {
        for code in code(&page) {
            let words: Vec<&str> = code.text.split_whitespace().collect();
            let called = words
                .iter()
                .position(|word| *word == "cargo")
                .filter(|at| code.is_fenced || *at < 3);
            if let Some(what) = called.and_then(|at| wrong_cargo(&words[at..], &packages)) {
                wrong.push(format!(
                    "{}: {what} in `{}`",
                    page.path.display(),
                    code.text.trim()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
