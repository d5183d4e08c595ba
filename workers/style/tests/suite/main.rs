//! Style networks on ONNX Runtime. Without the runtime these tests fail with installation instructions.

#![allow(clippy::unwrap_used)]

mod agreement;
mod models;
mod networks;
#[expect(dead_code, reason = "the tests of frames use more of it")]
mod onnx;
mod waters;

use std::path::Path;

use style::{Library, Runtime, StyleModel};

/// ONNX Runtime as installed by scripts/get-onnxruntime.sh, else from its usual location.
fn runtime() -> Runtime {
    let installed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.onnxruntime/libonnxruntime.so");
    let installed = installed.is_file().then_some(installed);
    Runtime::load(installed.as_deref()).unwrap_or_else(|missing| panic!("{missing}"))
}

/// A model of a user's folder.
fn model_of(onnx: &[u8]) -> StyleModel {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("test.onnx"), onnx).unwrap();
    let library = Library::embedded().unwrap().with_dir(folder.path()).unwrap();
    library.get("test").unwrap().clone()
}
