//! The styles that jobs may name: those of the start, and those that were added while the service ran.
//!
//! [`Styles::add`] is the only way in. Whoever has a network, from a request or from a training job, makes a
//! [`NewStyle`] of it, with as much of its card as is known, and calls `add`: the network is tried in a process of its own, stored, and
//! known from then on. The next job may name it; a worker that lacks it fetches it. A style is never changed or taken
//! away, since images name it.

mod folder;
pub(crate) mod routes;
pub(crate) mod trainings;
mod trial;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use spec::Vocabulary;
use style::{Library, LibraryError, ModelCard, StyleModel, is_name};
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
use trainings::Trainings;

/// Stands on the card of every style that was added.
const NO_PROMISE: &str =
    "it was added by a user: nobody has measured how stable it is from frame to frame or across sizes";

/// A network on its way to become a style.
pub(crate) struct NewStyle {
    pub(crate) onnx: Vec<u8>,
    /// What is known of it; the name, the file and the digest are right already.
    pub(crate) card: ModelCard,
}

impl NewStyle {
    /// An unverified network, known only by name. The caller adds what it knows beyond that.
    pub(crate) fn new(name: &str, onnx: Vec<u8>) -> Result<Self, Problem> {
        if !is_name(name) {
            let message = format!("name is `{name}` but must have 1 to 64 characters of a-z, 0-9, _ and -");
            return Err(Problem::field("/name", message));
        }
        let StyleModel { onnx, mut card, .. } = StyleModel::without_card(name, onnx);
        card.caveats = vec![NO_PROMISE.to_owned()];
        Ok(Self {
            onnx: onnx.into_owned(),
            card,
        })
    }
}

/// The styles at one moment, and the words that follow from them.
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

/// The styles of a service, and what it takes to add one.
pub(crate) struct Styles {
    known: RwLock<Arc<Known>>,
    /// Held while a style is added.
    folder: Mutex<Folder>,
    pub(crate) trainings: Trainings,
    /// Version of the ONNX Runtime that this machine's workers find, or why there is none.
    pub(crate) runtime: Result<String, String>,
    trial: Allowance,
    bytes: Arc<Bytes>,
    processes: Arc<Processes>,
    stop: CancellationToken,
}

impl Styles {
    /// The styles of the start and those that the folder of the service has. Reads files.
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
            trainings: Trainings::new(&config.worker_program, surroundings.limits.children),
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

    /// The current vocabulary: these styles, and the users' own waters.
    pub(crate) fn vocabulary(&self, waters: &Waters) -> Vocabulary {
        Vocabulary {
            waters: waters.words(),
            ..self.known().vocabulary.clone()
        }
    }

    /// The styles now.
    pub(crate) fn known(&self) -> Arc<Known> {
        Arc::clone(&self.known.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Copies the added styles into another data folder.
    pub(crate) fn copy_to(&self, data: &Path) -> std::io::Result<()> {
        let folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        folder.copy_to(data)
    }

    /// The card of a style that has this name already, if it is the same network.
    fn same(&self, new: &NewStyle) -> Result<Option<ModelCard>, Problem> {
        let known = self.known();
        let Some(model) = known.library.get(&new.card.name) else {
            return Ok(None);
        };
        if model.card.sha256 == imaging::digest::sha256(&new.onnx) {
            return Ok(Some(model.card.clone()));
        }
        let detail = format!(
            "the style `{}` is another network, with the digest {}; styles are never replaced, since images name them",
            model.name, model.card.sha256
        );
        Err(Problem::new(Slug::NameTaken, detail))
    }

    /// Stores a style that was tried, then knows it. Writes files.
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

    /// Adds a style: tries it, stores it, knows it. Returns its card, and whether it is new; the same network under the
    /// same name again changes nothing. Goes on to its end, once it was tried, when the caller goes away.
    pub(crate) async fn add(self: &Arc<Self>, new: NewStyle) -> Result<(ModelCard, bool), Problem> {
        if new.onnx.len() > limits::STYLE_BYTES {
            let (bytes, limit) = (new.onnx.len(), limits::STYLE_BYTES);
            let detail = format!("the model has {bytes} bytes, the limit is {limit}");
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
