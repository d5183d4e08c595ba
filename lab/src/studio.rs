//! Renders frames like any job.

use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::styles::StyleArguments;
use imaging::{Raster, codec};
use optics::plan::StageId;
use renderer::{Engine, LinearPicture, Rendered, SceneSource, Slot};
use serde_json::Value;
use spec::{Fidelity, Frame, Job, Vocabulary};
use style::Library;

/// One slot with its style models.
pub struct Studio {
    slot: Slot,
    vocabulary: Vocabulary,
}

impl Studio {
    /// A studio with the styles of a command.
    ///
    /// # Errors
    /// A style cannot be read.
    pub fn new(styles: &StyleArguments) -> Result<Self, Failure> {
        let (library, runtime) = (styles.library()?, styles.onnxruntime.as_deref());
        Ok(Self::with_library(library, runtime))
    }

    /// A studio with the shipped styles.
    ///
    /// # Panics
    /// The shipped styles are damaged.
    #[must_use]
    pub fn with_shipped_styles() -> Self {
        Self::with_library(Library::embedded().expect("the embedded style models"), None)
    }

    fn with_library(library: Library, onnxruntime: Option<&Path>) -> Self {
        Self {
            vocabulary: renderer::vocabulary(&library, true),
            slot: Slot::new(&Arc::new(Engine::new(library, onnxruntime))),
        }
    }

    /// A studio with the shipped styles and without some effects.
    ///
    /// # Panics
    /// As [`Studio::with_shipped_styles`].
    #[must_use]
    pub fn without_effects(effects: &[StageId]) -> Self {
        let mut studio = Self::with_shipped_styles();
        studio.slot.exclude(effects.to_vec());
        studio
    }

    /// A frame of a job that may use local files.
    ///
    /// # Errors
    /// All mistakes of the description.
    pub fn frame(&self, description: &Value, index: u64) -> Result<Frame, Failure> {
        let job = Job::parse(description.to_string().as_bytes(), &self.vocabulary);
        let frame = job.and_then(|job| job.resolve(index));
        frame.map_err(|invalid| cli::job::refused(Path::new("the description"), &invalid))
    }

    /// Renders a frame of local scenes.
    ///
    /// # Errors
    /// The frame cannot be rendered.
    pub fn render(&mut self, frame: &Frame) -> Result<Rendered, Failure> {
        let rendered = self.slot.render(frame, &SceneSource::Local);
        rendered.map_err(Failure::input)
    }

    /// The linear light of a frame at another fidelity.
    ///
    /// # Errors
    /// The frame cannot be rendered.
    pub fn linear(
        &mut self,
        frame: &Frame,
        fidelity: Fidelity,
        source: &SceneSource,
    ) -> Result<LinearPicture, Failure> {
        let mut frame = frame.clone();
        frame.fidelity = fidelity;
        self.slot.linear(&frame, source).map_err(Failure::input)
    }
}

/// An artifact of a frame.
///
/// # Errors
/// It was not rendered.
pub fn artifact<'a>(rendered: &'a Rendered, kind: &str) -> Result<&'a [u8], Failure> {
    let file = rendered.files.iter().find(|file| file.kind == kind);
    let file = file.with_context(|| format!("the frame has no artifact `{kind}`"))?;
    Ok(&file.bytes)
}

/// The codes of an artifact.
///
/// # Errors
/// It was not rendered or is not a picture.
pub fn raster(rendered: &Rendered, kind: &str) -> Result<Raster, Failure> {
    Ok(codec::decode_picture(artifact(rendered, kind)?).map_err(anyhow::Error::from)?)
}

/// Reads a description from a JSON file.
///
/// # Errors
/// The file cannot be read or is not JSON.
pub fn read_json(path: &Path) -> Result<Value, Failure> {
    serde_json::from_slice(&files::read(path)?)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
}
