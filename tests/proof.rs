//! The binary does what the binary before the last rebuild did: frame by frame, over HTTP, over an old data folder.

use std::process::Command;

use fathom_tests::{fathom, root};

/// Failure: a difference from `tests/proof` that `tests/proof/expected.txt` does not name with a reason, or a line there
/// that is no longer needed.
#[test]
fn frames_documents_and_an_old_data_folder_are_as_they_were() {
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
