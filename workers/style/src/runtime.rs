//! ONNX Runtime, loaded when the program runs.

use std::path::{Path, PathBuf};

use ort::environment::Environment;

use crate::library::StyleModel;
use crate::session::{Session, StyleError};

/// Name of the library wherever it is looked for.
const LIBRARY: &str = "libonnxruntime.so";
/// Folder that scripts/get-onnxruntime.sh fills.
const FOLDER: &str = ".onnxruntime";

/// There is no ONNX Runtime that can be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "style water needs ONNX Runtime, which {reason}: run scripts/get-onnxruntime.sh, or name the library with --onnxruntime"
)]
pub struct RuntimeMissing {
    reason: String,
}

/// A loaded ONNX Runtime.
pub struct Runtime {
    environment: Environment,
    version: String,
}

impl Runtime {
    /// Loads the library: the given file; else `ORT_DYLIB_PATH`; else beside the executable; else the folder
    /// `.onnxruntime` above the executable or above the working directory. A given file that does not load is an error, not a
    /// reason to look on.
    ///
    /// # Errors
    /// [`RuntimeMissing`], which says what to run.
    pub fn load(explicit: Option<&Path>) -> Result<Self, RuntimeMissing> {
        let named = explicit
            .map(Path::to_owned)
            .or_else(|| std::env::var_os("ORT_DYLIB_PATH").map(PathBuf::from));
        let Some(path) = named.or_else(found) else {
            return Err(RuntimeMissing {
                reason: "is not installed".to_owned(),
            });
        };
        let unusable = |reason: String| RuntimeMissing {
            reason: format!("cannot be loaded from {}: {reason}", path.display()),
        };
        if !path.is_file() {
            return Err(unusable("there is no such file".to_owned()));
        }
        let builder = ort::init_from(&path).map_err(|error| unusable(error.to_string()))?;
        let environment = builder
            .with_name("fathom")
            .build()
            .map_err(|error| unusable(error.to_string()))?;
        Ok(Self {
            environment,
            version: version(ort::info()),
        })
    }

    /// Version of the library.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Prepares a model to run, on one thread.
    ///
    /// # Errors
    /// [`StyleError::Model`] when the model cannot be read or has inputs that are not known.
    pub fn session(&self, model: &StyleModel) -> Result<Session, StyleError> {
        Session::new(&self.environment, model)
    }
}

fn found() -> Option<PathBuf> {
    let executable = std::env::current_exe().ok();
    let here = std::env::current_dir().ok();
    let beside = executable
        .as_deref()
        .and_then(Path::parent)
        .map(|folder| folder.join(LIBRARY));
    let above = |start: &Option<PathBuf>| {
        let folders = start.iter().flat_map(|path| path.ancestors());
        folders
            .map(|folder| folder.join(FOLDER).join(LIBRARY))
            .collect::<Vec<_>>()
    };
    beside
        .into_iter()
        .chain(above(&executable))
        .chain(above(&here))
        .find(|path| path.is_file())
}

/// The number behind `VERSION_NUMBER` or the like; the whole text if there is none.
fn version(info: &str) -> String {
    let numbers = info.split(|c: char| !c.is_ascii_digit() && c != '.');
    let looks_right = |part: &&str| part.split('.').count() == 3 && part.split('.').all(|n| !n.is_empty());
    numbers.into_iter().find(looks_right).unwrap_or(info).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_no_library_is_an_error_that_says_what_to_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nothing.so");
        let error = Runtime::load(Some(&path)).err().unwrap();
        assert!(
            error.to_string().contains("scripts/get-onnxruntime.sh"),
            "{error}"
        );
        std::fs::write(&path, b"not a library").unwrap();
        assert!(Runtime::load(Some(&path)).is_err());
    }

    #[test]
    fn the_version_is_read_out_of_the_build_information() {
        assert_eq!(
            version("ORT Build Info: git-branch=x, version 1.31.1, build type=Release"),
            "1.31.1"
        );
        assert_eq!(version("strange"), "strange");
    }
}
