//! Runs single commands of the binaries to completion.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// The repository's root.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the tests folder lies in the root")
        .to_owned()
}

/// The product's binary, built next to the test executables.
///
/// # Panics
/// If it was not built: tests of a binary must not pass without it.
#[must_use]
pub fn fathom() -> PathBuf {
    program("fathom")
}

fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own file");
    let binary = test
        .parent()
        .and_then(Path::parent)
        .expect("tests lie in deps/")
        .join(name);
    assert!(
        binary.is_file(),
        "{} is missing: build the workspace first",
        binary.display()
    );
    binary
}

/// Runs a command of `fathom` to completion.
///
/// # Panics
/// If the binary cannot be started.
#[must_use]
pub fn run(arguments: &[&str]) -> Output {
    finish(&mut command("fathom", arguments))
}

/// Runs a command of `fathom` to completion, for a terminal of this width.
///
/// # Panics
/// If the binary cannot be started.
#[must_use]
pub fn run_in_columns(columns: usize, arguments: &[&str]) -> Output {
    finish(command("fathom", arguments).env("COLUMNS", columns.to_string()))
}

/// Runs a command of `fathom-lab` to completion.
///
/// # Panics
/// If the binary cannot be started.
#[must_use]
pub fn run_lab(arguments: &[&str]) -> Output {
    finish(&mut command("fathom-lab", arguments))
}

/// Renders the photos of the muddy water, and returns the first.
///
/// # Panics
/// If they cannot be rendered.
#[must_use]
pub fn muddy_photo(folder: &Path) -> PathBuf {
    let photos = folder.join("photos");
    let out = photos.to_str().expect("text");
    let output = run(&["render", "models/photos/muddy.json", "--out", out]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    photos.join("0/rgb.png")
}

fn command(name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program(name));
    command
        .args(arguments)
        .env_remove("FATHOM_TOKEN")
        .env_remove("COLUMNS")
        // An unused port: a service on the default port is not part of the test.
        .env("FATHOM_SERVER", "http://127.0.0.1:9")
        .current_dir(root());
    command
}

fn finish(command: &mut Command) -> Output {
    command.output().expect("the binary starts")
}

/// The digest of a job by `fathom render`, without any service.
///
/// # Panics
/// If a frame fails or is missing.
#[must_use]
pub fn digest_by_render(job: &Value, folder: &Path, slots: &str) -> String {
    let (spec, out) = (folder.join("job.json"), folder.join("out"));
    std::fs::write(&spec, job.to_string()).expect("a writable folder");
    let path = |path: &Path| path.to_str().expect("a path of text").to_owned();
    let output = run(&["render", &path(&spec), "--out", &path(&out), "--slots", slots]);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{printed}\n{complaint}");
    let digest = printed.lines().find_map(|line| line.strip_prefix("digest "));
    let records = std::fs::read_to_string(out.join("records.jsonl")).expect("records");
    assert_eq!(records.lines().count() as u64, job["count"].as_u64().unwrap_or(1));
    digest.expect("render prints a digest").to_owned()
}
