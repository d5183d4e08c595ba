//! Errors without a usable ONNX Runtime. No library is loaded in this process.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use style::{Runtime, RuntimeMissing};

fn refusal(path: &Path) -> String {
    let error = Runtime::load(Some(path)).unwrap_err();
    assert!(matches!(error, RuntimeMissing::Unusable { .. }), "{error:?}");
    let text = error.to_string();
    assert!(
        text.contains("scripts/get-onnxruntime.sh") && text.contains(&path.display().to_string()),
        "{text}"
    );
    text
}

/// The C library of this process: a library, but the wrong one.
fn c_library() -> PathBuf {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let paths = maps.lines().filter_map(|line| line.split_whitespace().last());
    PathBuf::from(paths.into_iter().find(|path| path.contains("libc.so")).unwrap())
}

#[test]
fn a_file_that_does_not_exist_is_named() {
    let folder = tempfile::tempdir().unwrap();
    assert!(refusal(&folder.path().join("nothing.so")).contains("No such file"));
}

#[test]
fn a_file_or_a_folder_that_is_no_library_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    let text = folder.join("text.so");
    std::fs::write(&text, b"not a library").unwrap();
    refusal(&text);
    refusal(&folder);
}

#[test]
fn a_library_that_is_no_onnx_runtime_is_refused() {
    let library = c_library().canonicalize().unwrap();
    assert!(refusal(&library).contains("OrtGetApiBase"));
}
