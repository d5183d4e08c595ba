//! Renders frames like any job.

use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use cli::exit::Failure;
use imaging::{Raster, codec};
use renderer::{Engine, Rendered, Round, SceneSource, Slot, Traced, Tracing, WaterLight};
use serde_json::Value;
use spec::{Frame, Job};
use style::Library;

/// One slot with its style models.
pub(crate) struct Studio {
    pub(crate) library: Library,
    slot: Slot,
}

impl Studio {
    pub(crate) fn new(library: Library, onnxruntime: Option<&Path>) -> Self {
        let engine = Arc::new(Engine::new(library.clone(), onnxruntime));
        Self {
            library,
            slot: Slot::new(&engine),
        }
    }

    /// Creates a studio with the shipped styles.
    pub(crate) fn with_shipped_styles() -> Result<Self, Failure> {
        let library = Library::embedded().context("the embedded style models")?;
        Ok(Self::new(library, None))
    }

    /// A frame of a job that may use local files.
    pub(crate) fn frame(&self, description: &Value, index: u64) -> Result<Frame, Failure> {
        let vocabulary = renderer::vocabulary(&self.library, true);
        let job = Job::parse(description.to_string().as_bytes(), &vocabulary);
        let frame = job.and_then(|job| job.resolve(index));
        frame.map_err(|invalid| cli::job::refused(Path::new("the description"), &invalid))
    }

    /// The light of a frame in its water, limited to the effects of the Monte Carlo truth, with or without the veil of daylight.
    pub(crate) fn water_light(&mut self, frame: &Frame, has_daylight: bool) -> Result<WaterLight, Failure> {
        self.slot
            .water_light(frame, &SceneSource::Local, has_daylight)
            .map_err(Failure::input)
    }

    /// The light of a frame by Monte Carlo.
    pub(crate) fn trace(
        &mut self,
        frame: &Frame,
        tracing: &Tracing,
        round: Round<'_>,
    ) -> Result<Option<Traced>, Failure> {
        self.slot
            .trace(frame, &SceneSource::Local, tracing, round)
            .map_err(Failure::input)
    }

    pub(crate) fn render(&mut self, frame: &Frame) -> Result<Rendered, Failure> {
        self.slot
            .render(frame, &SceneSource::Local)
            .map_err(Failure::input)
    }
}

/// An artifact, or `None` if it was not rendered.
pub(crate) fn artifact<'a>(rendered: &'a Rendered, kind: &str) -> Option<&'a [u8]> {
    let file = rendered.files.iter().find(|file| file.kind == kind)?;
    Some(&file.bytes)
}

/// The codes of a requested artifact.
pub(crate) fn raster(rendered: &Rendered, kind: &str) -> Result<Raster, Failure> {
    let bytes = artifact(rendered, kind).with_context(|| format!("the frame has no artifact `{kind}`"))?;
    Ok(codec::decode_picture(bytes).map_err(anyhow::Error::from)?)
}
