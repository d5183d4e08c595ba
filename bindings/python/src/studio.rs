//! Rendering resources of this process.

use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::PyResult;
use pyo3::exceptions::PyValueError;
use renderer::{Engine, Slot};
use style::Library;

/// The style networks and the idle slots.
pub(crate) struct Studio {
    pub(crate) engine: Arc<Engine>,
    idle: Mutex<Vec<Slot>>,
}

impl Studio {
    /// The shared studio of the shipped styles, or a separate one with the styles of a folder.
    pub(crate) fn open(styles: Option<&Path>, onnxruntime: Option<&Path>) -> PyResult<Arc<Self>> {
        static SHIPPED: OnceLock<Arc<Studio>> = OnceLock::new();
        let is_shipped = styles.is_none() && onnxruntime.is_none();
        if let Some(studio) = SHIPPED.get().filter(|_| is_shipped) {
            return Ok(Arc::clone(studio));
        }
        let library = match styles {
            Some(folder) => Library::embedded().and_then(|library| library.with_dir(folder)),
            None => Library::embedded(),
        };
        let library = library.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let studio = Arc::new(Self {
            engine: Arc::new(Engine::new(library, onnxruntime)),
            idle: Mutex::default(),
        });
        Ok(if is_shipped {
            Arc::clone(SHIPPED.get_or_init(|| studio))
        } else {
            studio
        })
    }

    /// An idle slot, or a new one: there are at most as many as rendering threads.
    pub(crate) fn take(&self) -> Slot {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| Slot::new(&self.engine))
    }

    /// Returns a slot with its caches for the next frame.
    pub(crate) fn keep(&self, slot: Slot) {
        self.idle
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(slot);
    }
}
