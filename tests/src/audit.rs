//! The audit by `tests/chaos/audit.py`, and the C libraries in the same folder.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{Service, root};

/// Audits the folder of a stopped service; these jobs must exist. Without accepted jobs the catalogue may be missing.
///
/// # Panics
/// If anything is wrong.
pub fn audit(data: &Path, accepted: &[&str], when: &str) {
    if accepted.is_empty() && !data.join("catalogue.sqlite").exists() {
        return;
    }
    let list = data.with_extension("accepted");
    std::fs::write(&list, accepted.join("\n")).expect("a list of jobs");
    check(&["whole".as_ref(), data.as_os_str(), list.as_os_str()], when);
}

/// Compares a service's responses with its folder.
///
/// # Panics
/// If anything is wrong.
pub fn audit_answers(data: &Path, service: &Service) {
    check(
        &["answers".as_ref(), data.as_os_str(), service.url.as_ref()],
        "what is served",
    );
}

fn check(arguments: &[&OsStr], when: &str) {
    let output = Command::new("python3")
        .arg(root().join("tests/chaos/audit.py"))
        .args(arguments)
        .output()
        .expect("python3 is there");
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{when}: {text}");
}

/// Compiles a library of `tests/chaos` for LD_PRELOAD.
///
/// # Panics
/// Without a C compiler.
#[must_use]
pub fn compile(source: &str, folder: &Path) -> PathBuf {
    let library = folder.join(source).with_extension("so");
    let built = Command::new("cc")
        .args(["-O1", "-shared", "-fPIC", "-o"])
        .arg(&library)
        .arg(root().join("tests/chaos").join(source))
        .arg("-ldl")
        .status();
    assert!(
        built.is_ok_and(|status| status.success()),
        "a C compiler is needed"
    );
    library
}
