//! Rendering resources of this process.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::SystemTime;

use pyo3::PyResult;
use pyo3::exceptions::PyValueError;
use renderer::{Engine, PictureNetworks, Slot};
use style::Library;

/// The style networks and the idle slots.
pub(crate) struct Studio {
    pub(crate) engine: Arc<Engine>,
    idle: Mutex<Vec<Slot>>,
    idle_networks: Mutex<Vec<PictureNetworks>>,
}

/// The inputs of a studio. A changed folder is a different origin.
#[derive(PartialEq)]
struct Origin {
    styles: Option<PathBuf>,
    onnxruntime: Option<PathBuf>,
    /// Name, bytes and time of each file of the folder, in order.
    files: Vec<(OsString, u64, Option<SystemTime>)>,
}

impl Origin {
    fn new(styles: Option<&Path>, onnxruntime: Option<&Path>) -> Self {
        let entries = styles
            .and_then(|folder| folder.read_dir().ok())
            .into_iter()
            .flatten();
        let mut files: Vec<_> = entries
            .filter_map(|entry| {
                let entry = entry.ok()?;
                let metadata = entry.metadata().ok()?;
                Some((entry.file_name(), metadata.len(), metadata.modified().ok()))
            })
            .collect();
        files.sort();
        Self {
            styles: styles.map(Path::to_owned),
            onnxruntime: onnxruntime.map(Path::to_owned),
            files,
        }
    }
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
            idle_networks: Mutex::default(),
        });
        Ok(if is_shipped {
            Arc::clone(SHIPPED.get_or_init(|| studio))
        } else {
            studio
        })
    }

    /// As [`Studio::open`], but keeps the last one until its folder changes, so that its networks stay loaded.
    pub(crate) fn open_recent(styles: Option<&Path>, onnxruntime: Option<&Path>) -> PyResult<Arc<Self>> {
        static RECENT: Mutex<Option<(Origin, Arc<Studio>)>> = Mutex::new(None);
        if styles.is_none() && onnxruntime.is_none() {
            return Self::open(None, None);
        }
        let origin = Origin::new(styles, onnxruntime);
        let mut recent = RECENT.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, studio)) = &*recent
            && *known == origin
        {
            return Ok(Arc::clone(studio));
        }
        let studio = Self::open(styles, onnxruntime)?;
        *recent = Some((origin, Arc::clone(&studio)));
        Ok(studio)
    }

    /// Idle networks, or new ones.
    pub(crate) fn take_networks(&self) -> PictureNetworks {
        let idle = self
            .idle_networks
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop();
        idle.unwrap_or_else(|| PictureNetworks::new(&self.engine))
    }

    /// Returns networks for the next picture.
    pub(crate) fn keep_networks(&self, networks: PictureNetworks) {
        let mut idle = self.idle_networks.lock().unwrap_or_else(PoisonError::into_inner);
        idle.push(networks);
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
