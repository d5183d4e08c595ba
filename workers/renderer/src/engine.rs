//! What all slots of a process share.

use std::path::Path;

use style::{Library, Runtime, RuntimeMissing};

/// The style models and the runtime that runs them. A process without the runtime renders everything but style.
pub struct Engine {
    runtime: Result<Runtime, RuntimeMissing>,
    library: Library,
}

impl Engine {
    /// Loads ONNX Runtime: from this file if there is one, else from where it usually lies.
    #[must_use]
    pub fn new(library: Library, onnxruntime: Option<&Path>) -> Self {
        Self {
            runtime: Runtime::load(onnxruntime),
            library,
        }
    }

    /// The runtime of the style networks.
    ///
    /// # Errors
    /// [`RuntimeMissing`], which says how to get it.
    pub fn runtime(&self) -> Result<&Runtime, &RuntimeMissing> {
        self.runtime.as_ref()
    }

    /// The style models.
    #[must_use]
    pub fn library(&self) -> &Library {
        &self.library
    }
}
