//! ONNX Runtime, loaded at run time.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use ort::environment::Environment;
use ort::{LoadDynamicError, MINOR_VERSION};

use crate::error::StyleError;
use crate::library::StyleModel;
use crate::search::{Surroundings, candidates};
use crate::session::Session;

/// No usable ONNX Runtime.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RuntimeMissing {
    /// No file was named, and none was found.
    #[error(
        "this style water needs ONNX Runtime, which is not installed: run scripts/get-onnxruntime.sh, or name the library with --onnxruntime or ORT_DYLIB_PATH"
    )]
    NotInstalled,
    /// The file cannot be loaded, or is no ONNX Runtime, or too old a one.
    #[error(
        "this style water needs ONNX Runtime, which cannot be loaded from {}: {reason}; run scripts/get-onnxruntime.sh for one that fits",
        path.display()
    )]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// The process has loaded another library before, and a process takes one only.
    #[error("ONNX Runtime cannot be loaded from {}: this process already uses {}", path.display(), loaded.display())]
    AnotherLoaded {
        /// The file that was asked for.
        path: PathBuf,
        /// The file in use.
        loaded: PathBuf,
    },
}

/// A loaded ONNX Runtime; a clone is another handle to the same one.
#[derive(Debug, Clone)]
pub struct Runtime {
    environment: Environment,
    path: PathBuf,
    version: String,
}

/// What this process has loaded. `ort` takes one library and one environment in the life of a process and refuses the
/// second even after the first is dropped, so the first is kept.
static LOADED: Mutex<Option<Runtime>> = Mutex::new(None);

impl Runtime {
    /// Loads the library: the file that is given; else the one that `ORT_DYLIB_PATH` names; else `libonnxruntime.so`
    /// beside the executable; else the one in a folder `.onnxruntime` beside or up to three folders above the
    /// executable or the working directory. A named file that does not load is an error, not a reason to look
    /// further. Loading again gives the same runtime.
    ///
    /// # Errors
    /// [`RuntimeMissing`], which says what to run.
    pub fn load(explicit: Option<&Path>) -> Result<Self, RuntimeMissing> {
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let (None, Some(runtime)) = (explicit, &*loaded) {
            return Ok(runtime.clone());
        }
        let path = match explicit {
            Some(path) => path.to_owned(),
            None => {
                candidates(&Surroundings::of_this_process())
                    .find(|candidate| candidate.named || candidate.path.is_file())
                    .ok_or(RuntimeMissing::NotInstalled)?
                    .path
            }
        };
        // `ort` would look for a relative path beside the executable first.
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

    /// Version of the library, such as `1.31.1`; the description of the build where the library does not carry one.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The file it was loaded from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Prepares a model of any form to run, on one thread. The shipped waters do not need it: [`Session::native`].
    ///
    /// # Errors
    /// [`StyleError::Model`] when the file is no model, or has inputs or outputs of another form.
    pub fn session(&self, model: &StyleModel) -> Result<Session, StyleError> {
        Session::onnx(&self.environment, model)
    }
}

fn unusable(path: &Path, reason: String) -> RuntimeMissing {
    RuntimeMissing::Unusable {
        path: path.to_owned(),
        reason,
    }
}

/// Why a file was rejected. The loader's own text leaves out what the system said.
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

/// The version in the name of the library's symbol version, `VERS_1.31.1`. `ort` exposes only
/// the build description, which has no version in it.
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
