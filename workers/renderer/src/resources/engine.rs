//! Models and runtime shared by all slots of a process.

use std::path::{Path, PathBuf};
use std::sync::{OnceLock, PoisonError, RwLock};

use style::{Library, Runtime, RuntimeMissing};

/// The style models and ONNX Runtime, which runs networks of other architectures. Everything else renders without it.
pub struct Engine {
    onnxruntime: Option<PathBuf>,
    runtime: OnceLock<Result<Runtime, RuntimeMissing>>,
    library: RwLock<Library>,
}

impl Engine {
    /// ONNX Runtime is loaded on first use, from this file or from its standard location.
    #[must_use]
    pub fn new(library: Library, onnxruntime: Option<&Path>) -> Self {
        Self {
            onnxruntime: onnxruntime.map(Path::to_owned),
            runtime: OnceLock::new(),
            library: RwLock::new(library),
        }
    }

    /// ONNX Runtime.
    ///
    /// # Errors
    /// [`RuntimeMissing`], whose message explains how to install the runtime.
    pub fn runtime(&self) -> Result<&Runtime, &RuntimeMissing> {
        self.runtime
            .get_or_init(|| Runtime::load(self.onnxruntime.as_deref()))
            .as_ref()
    }

    /// The style models; cloning is cheap.
    #[must_use]
    pub fn library(&self) -> Library {
        self.library
            .read()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Replaces the style models.
    pub(crate) fn replace_library(&self, library: Library) {
        *self.library.write().unwrap_or_else(PoisonError::into_inner) = library;
    }
}
