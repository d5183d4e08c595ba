//! Loads ONNX Runtime at run time.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use ort::environment::Environment;
use ort::{LoadDynamicError, MINOR_VERSION};

use crate::error::StyleError;
use crate::library::StyleModel;
use crate::picture::{NetworkError, PictureNetwork};
use crate::search::{SearchPaths, candidates};
use crate::session::Session;

/// No usable ONNX Runtime.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RuntimeMissing {
    /// No file was named or found.
    #[error(
        "this network needs ONNX Runtime, which is not installed: run scripts/get-onnxruntime.sh, or name the library with --onnxruntime or ORT_DYLIB_PATH"
    )]
    NotInstalled,
    /// The file cannot be loaded, is not ONNX Runtime, or is too old.
    #[error(
        "this network needs ONNX Runtime, which cannot be loaded from {}: {reason}; run scripts/get-onnxruntime.sh for one that fits",
        path.display()
    )]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
    /// The process has loaded another library before, and can only load one.
    #[error("ONNX Runtime cannot be loaded from {}: this process already uses {}", path.display(), loaded.display())]
    AnotherLoaded {
        /// The requested file.
        path: PathBuf,
        /// The file in use.
        loaded: PathBuf,
    },
}

/// A loaded ONNX Runtime; clones share it.
#[derive(Debug, Clone)]
pub struct Runtime {
    environment: Environment,
    path: PathBuf,
    version: String,
}

/// The library of this process. `ort` supports one library and one environment per process and refuses a second one
/// even after the first is dropped, so the first is kept.
static LOADED: Mutex<Option<Runtime>> = Mutex::new(None);

impl Runtime {
    /// Loads the library: the given file; else `ORT_DYLIB_PATH`; else `libonnxruntime.so` next to the executable; else
    /// the one in a folder `.onnxruntime` next to or up to three folders above the executable or the working directory.
    /// A named file that does not load is an error and ends the search. Loading again returns the same runtime.
    ///
    /// # Errors
    /// [`RuntimeMissing`] with installation instructions.
    pub fn load(explicit: Option<&Path>) -> Result<Self, RuntimeMissing> {
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let (None, Some(runtime)) = (explicit, &*loaded) {
            return Ok(runtime.clone());
        }
        let path = match explicit {
            Some(path) => path.to_owned(),
            None => {
                candidates(&SearchPaths::of_this_process())
                    .find(|candidate| candidate.named || candidate.path.is_file())
                    .ok_or(RuntimeMissing::NotInstalled)?
                    .path
            }
        };
        // `ort` would search for a relative path next to the executable first.
        let path = path
            .canonicalize()
            .map_err(|error| unusable(&path, error.to_string()))?;
        if let Some(runtime) = &*loaded {
            if runtime.path == path {
                return Ok(runtime.clone());
            }
            let loaded = runtime.path.clone();
            return Err(RuntimeMissing::AnotherLoaded { path, loaded });
        }
        let runtime = Self::open(path)?;
        *loaded = Some(runtime.clone());
        Ok(runtime)
    }

    fn open(path: PathBuf) -> Result<Self, RuntimeMissing> {
        let builder = ort::init_from(&path).map_err(|error| unusable(&path, reason(&error)))?;
        let environment = builder
            .with_name("fathom")
            .with_telemetry(false)
            .build()
            .map_err(|error| unusable(&path, error.to_string()))?;
        let bytes = std::fs::read(&path).map_err(|error| unusable(&path, error.to_string()))?;
        let version = version_of(&bytes).unwrap_or_else(|| ort::info().to_owned());
        Ok(Self {
            environment,
            path,
            version,
        })
    }

    /// Version of the library, such as `1.31.1`, or the build description if the library has no version.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The file it was loaded from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Prepares a model of any architecture to run on one thread. The shipped waters do not need it:
    /// [`Session::native`].
    ///
    /// # Errors
    /// [`StyleError::Model`] if the file is not a model, or has inputs or outputs of another shape.
    pub fn session(&self, model: &StyleModel) -> Result<Session, StyleError> {
        Session::onnx(&self.environment, model)
    }

    /// Prepares an enhancer or a metric to run on one thread.
    ///
    /// # Errors
    /// [`NetworkError`] if it is a style, if the file is not a model, or if its input or output has another shape.
    pub fn picture_network(&self, model: &StyleModel) -> Result<PictureNetwork, NetworkError> {
        PictureNetwork::new(&self.environment, model)
    }
}

fn unusable(path: &Path, reason: String) -> RuntimeMissing {
    RuntimeMissing::Unusable {
        path: path.to_owned(),
        reason,
    }
}

/// The cause of a rejection. The loader's text omits the system's error.
fn reason(error: &LoadDynamicError) -> String {
    match error {
        LoadDynamicError::Dlopen { error, path } => {
            let cause = error
                .source()
                .map_or_else(|| error.to_string(), ToString::to_string);
            let named = format!("{}: ", path.display());
            cause.strip_prefix(&named).unwrap_or(&cause).to_owned()
        }
        LoadDynamicError::MissingApi { .. } => "it is no ONNX Runtime: it lacks `OrtGetApiBase`".to_owned(),
        LoadDynamicError::BadVersion { version_str, .. } => {
            format!("it is version {version_str} but 1.{MINOR_VERSION} or newer is needed")
        }
        other => other.to_string(),
    }
}

/// The version from the library's symbol version, `VERS_1.31.1`. `ort` only exposes the build description, which lacks
/// it.
fn version_of(library: &[u8]) -> Option<String> {
    const TAG: &[u8] = b"\0VERS_";
    let numbers = library
        .windows(TAG.len())
        .enumerate()
        .filter(|(_, window)| *window == TAG);
    numbers
        .filter_map(|(at, _)| {
            let rest = &library[at + TAG.len()..];
            let end = rest.iter().position(|&byte| byte == 0)?;
            std::str::from_utf8(&rest[..end]).ok()
        })
        .find(|text| text.split('.').all(|number| number.parse::<u32>().is_ok()))
        .map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_the_name_of_the_symbol_version() {
        let library = b"\x7fELF\0VERS_\0\0VERS_next\0OrtGetApiBase\0VERS_1.31.1\0libm.so.6\0";
        assert_eq!(version_of(library).as_deref(), Some("1.31.1"));
        assert_eq!(version_of(b"\x7fELF\0GLIBC_2.17\0"), None);
        assert_eq!(version_of(b"\0VERS_1.2"), None);
    }
}
