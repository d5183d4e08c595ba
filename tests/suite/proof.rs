//! The binary renders the frames and writes the documents of `tests/proof`.

use std::process::Command;

use fathom_tests::{fathom, root};

/// Failure: a difference from `tests/proof`. After an intended change, `scripts/proof.sh --make` regenerates it.
#[test]
fn frames_and_documents_are_as_recorded() {
    let output = Command::new("bash")
        .args(["scripts/proof.sh", "--check"])
        .env("FATHOM", fathom())
        .current_dir(root())
        .output()
        .expect("bash starts");
    let printed = String::from_utf8_lossy(&output.stdout);
    let complaint = String::from_utf8_lossy(&output.stderr);
    print!("{printed}");
    assert!(output.status.success(), "{printed}\n{complaint}");
}
