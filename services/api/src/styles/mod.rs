//! The styles that jobs may use: configured ones, and those added at run time.
//!
//! [`Styles::add`] is the only entry point. Uploads and trainings make a [`NewStyle`] with the known parts of its
//! card and call `add`: the network is tried in a separate process, stored, and available to the next job. Workers
//! without it fetch it. Styles are never changed or deleted, because images reference them.

mod folder;
mod new_style;
pub(crate) mod routes;
mod train;
pub(crate) mod trainings;
mod trial;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use spec::Vocabulary;
use style::{Library, LibraryError, ModelCard};
use tempfile::TempDir;
use tokio_util::sync::CancellationToken;

use crate::bytes::Bytes;
use crate::config::{Config, Surroundings};
use crate::http::problem::{Problem, Slug};
use crate::limits;
use crate::processes::Processes;
use crate::processes::child::Allowance;
use crate::waters::Waters;

use folder::Folder;
pub use folder::{AddedStyleError, added_styles};
pub(crate) use new_style::NewStyle;
use trainings::Trainings;

/// The current styles, and the vocabulary derived from them.
pub(crate) struct Known {
    pub(crate) library: Library,
    pub(crate) vocabulary: Vocabulary,
}

impl Known {
    fn new(library: Library) -> Arc<Self> {
        let vocabulary = renderer::vocabulary(&library, false);
        Arc::new(Self { library, vocabulary })
    }
}

/// The styles of a service, and the state for adding one.
pub(crate) struct Styles {
    known: RwLock<Arc<Known>>,
    /// Held while a style is added.
    folder: Mutex<Folder>,
    pub(crate) trainings: Trainings,
    /// Version of the ONNX Runtime available to this machine's workers, or why there is none.
    pub(crate) runtime: Result<String, String>,
    trial: Allowance,
    bytes: Arc<Bytes>,
    processes: Arc<Processes>,
    stop: CancellationToken,
}

impl Styles {
    /// Loads the configured styles and those in the data folder. Reads files.
    pub(crate) fn open(
        config: &Config,
        surroundings: &Surroundings,
        bytes: Arc<Bytes>,
        processes: Arc<Processes>,
        stop: CancellationToken,
    ) -> Result<Self, AddedStyleError> {
        let library = added_styles(&config.data, config.library.clone())?;
        Ok(Self {
            known: RwLock::new(Known::new(library)),
            folder: Mutex::new(Folder::open(&config.data)?),
            trainings: Trainings::new(&config.program, surroundings.limits.children),
            runtime: surroundings.style_runtime.clone(),
            trial: Allowance {
                time: config.style_trial,
                memory_bytes: limits::STYLE_TRIAL_MEMORY_BYTES,
            },
            processes,
            bytes,
            stop,
        })
    }

    /// The current vocabulary: these styles and the user-defined waters.
    pub(crate) fn vocabulary(&self, waters: &Waters) -> Vocabulary {
        Vocabulary {
            waters: waters.words(),
            ..self.known().vocabulary.clone()
        }
    }

    /// The current styles.
    pub(crate) fn known(&self) -> Arc<Known> {
        Arc::clone(&self.known.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// A temporary folder for photos.
    pub(crate) fn temporary_folder(&self) -> std::io::Result<TempDir> {
        self.processes.scratch.folder()
    }

    /// Copies the added styles into another data folder.
    pub(crate) fn copy_to(&self, data: &Path) -> std::io::Result<()> {
        let folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        folder.copy_to(data)
    }

    /// The card of an existing style with this name, if it is the same network.
    fn same(&self, new: &NewStyle) -> Result<Option<ModelCard>, Problem> {
        let known = self.known();
        let Some(model) = known.library.get(&new.card.name) else {
            return Ok(None);
        };
        let (old, card) = (&model.card, &new.card);
        let is_same_use = old.role == card.role && old.picture_input() == card.picture_input();
        if old.sha256 == imaging::digest::sha256(&new.onnx) && old.scale == card.scale && is_same_use {
            return Ok(Some(model.card.clone()));
        }
        let detail = format!(
            "the {} `{}` exists with another network, role, scale, layout or size rule, digest {}; choose another name",
            old.role.name(),
            model.name,
            old.sha256
        );
        Err(Problem::new(Slug::NameTaken, detail))
    }

    /// Stores a tried style and adds it to the current ones. Writes files.
    fn keep(&self, new: NewStyle) -> Result<(ModelCard, bool), Problem> {
        let mut folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(card) = self.same(&new)? {
            return Ok((card, false));
        }
        folder.has_room_for(new.onnx.len() as u64)?;
        let card = serde_json::to_string(&new.card).map_err(|error| Problem::internal(&error))?;
        let library = self.known().library.clone();
        let library = library
            .with_model(&new.card.name, new.onnx.clone(), Some(&card))
            .map_err(|error: LibraryError| Problem::field("/model", error.to_string()))?;
        folder
            .put(&new.card.name, &new.card.sha256, &new.onnx, &card)
            .map_err(|error| crate::http::failure::writing(&error))?;
        *self.known.write().unwrap_or_else(PoisonError::into_inner) = Known::new(library);
        tracing::info!(
            style = new.card.name,
            sha256 = new.card.sha256,
            "a style was added"
        );
        Ok((new.card, true))
    }

    /// Adds a style: tries it, stores it, makes it available. Returns its card, and whether it is new; repeating it
    /// has no effect. After the trial it completes even if the caller is dropped.
    pub(crate) async fn add(self: &Arc<Self>, new: NewStyle) -> Result<(ModelCard, bool), Problem> {
        if new.onnx.len() > limits::STYLE_BYTES {
            let (bytes, limit) = (new.onnx.len(), limits::STYLE_BYTES);
            let detail = format!("the model has {bytes} bytes; must be at most {limit}");
            return Err(Problem::new(Slug::TooLarge, detail));
        }
        if let Some(card) = self.same(&new)? {
            return Ok((card, false));
        }
        self.bytes.space.room().await?;
        self.try_out(&new).await?;
        let styles = Arc::clone(self);
        self.processes.compute.run(move || styles.keep(new)).await?
    }
}
