//! Re-executes a test on a small in-memory file system that is private to it.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

/// Environment variable with the folder of the small disk.
pub(crate) const FOLDER: &str = "FATHOM_SMALL_DISK";
/// Set where no file system can be mounted: the tests then report that they are skipped.
const SKIP: &str = "FATHOM_SKIP_SMALL_DISK";
/// Commands for a mount that ends with the process: unprivileged, and as root where user namespaces are forbidden.
const WAYS: [&[&str]; 2] = [&["--user", "--map-root-user", "--mount"], &["--mount"]];
const SCRIPT: &str = "mount -t tmpfs -o $1 none $2 && exec \"$3\" \"$4\" --exact --ignored --nocapture";

/// Runs the ignored test `name` on a disk of `size`, such as `size=40m`.
///
/// # Panics
/// If it fails, and if no file system can be mounted unless [`SKIP`] is set.
pub(crate) fn run(name: &str, size: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut refusals = Vec::new();
    for way in WAYS {
        match start(way, name, size, folder.path()) {
            Ok(output) if text(&output).contains("running 1 test") => {
                assert!(output.status.success(), "{}", text(&output));
                print!("{}", String::from_utf8_lossy(&output.stdout));
                return;
            }
            Ok(output) => refusals.push(text(&output)),
            Err(error) => refusals.push(error.to_string()),
        }
    }
    let reason = format!(
        "no small file system can be mounted here: {}",
        refusals.join("; ").trim()
    );
    assert!(
        std::env::var_os(SKIP).is_some(),
        "{reason}\nset {SKIP} to skip {name}"
    );
    // Bypasses the test harness, which hides the output of a passing test.
    let _ = writeln!(std::io::stderr(), "SKIPPED {name}: {reason}");
}

fn start(way: &[&str], name: &str, size: &str, folder: &Path) -> std::io::Result<Output> {
    Command::new("unshare")
        .args(way)
        .args(["sh", "-c", SCRIPT, "sh", size])
        .arg(folder)
        .arg(std::env::current_exe()?)
        .arg(name)
        .env(FOLDER, folder)
        .output()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}
