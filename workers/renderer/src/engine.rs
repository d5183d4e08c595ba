//! What all slots of a process share.

use std::path::{Path, PathBuf};
use std::sync::{OnceLock, PoisonError, RwLock};

use style::{Library, Runtime, RuntimeMissing};

/// The style models and the runtime of those that are not ours. A process without it renders everything else.
pub struct Engine {
    onnxruntime: Option<PathBuf>,
    runtime: OnceLock<Result<Runtime, RuntimeMissing>>,
    library: RwLock<Library>,
}

impl Engine {
    /// ONNX Runtime is loaded when it is first needed: from this file if there is one, else from where it usually
    /// lies.
    #[must_use]
    pub fn new(library: Library, onnxruntime: Option<&Path>) -> Self {
        Self {
            onnxruntime: onnxruntime.map(Path::to_owned),
            runtime: OnceLock::new(),
            library: RwLock::new(library),
        }
    }

    /// The runtime of the style networks that are not ours.
    ///
    /// # Errors
    /// [`RuntimeMissing`], which says how to get it.
    pub fn runtime(&self) -> Result<&Runtime, &RuntimeMissing> {
        self.runtime
            .get_or_init(|| Runtime::load(self.onnxruntime.as_deref()))
            .as_ref()
    }

    /// The style models; a copy is another handle to them.
    #[must_use]
    pub fn library(&self) -> Library {
        self.library
            .read()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Knows these models from now on.
    pub(crate) fn replace_library(&self, library: Library) {
        *self.library.write().unwrap_or_else(PoisonError::into_inner) = library;
    }
}
