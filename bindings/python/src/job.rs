//! A job and its frames.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use renderer::{Contents, SceneSource};
use serde_json::json;
use spec::{ArtifactKind, Enhancement, Frame};

use crate::arrays::{Array, of_content};
use crate::errors::{invalid_job, render_error};
use crate::studio::Studio;

/// A checked job with its studio.
#[pyclass(frozen, module = "fathom._native")]
pub(crate) struct Job {
    job: spec::Job,
    studio: Arc<Studio>,
}

#[pymethods]
impl Job {
    #[new]
    fn new(
        py: Python<'_>,
        text: &str,
        styles: Option<PathBuf>,
        onnxruntime: Option<PathBuf>,
    ) -> PyResult<Self> {
        let studio = Studio::open(styles.as_deref(), onnxruntime.as_deref())?;
        let vocabulary = renderer::vocabulary(&studio.engine.library(), true);
        let job =
            spec::Job::parse(text.as_bytes(), &vocabulary).map_err(|invalid| invalid_job(py, &invalid))?;
        Ok(Self { job, studio })
    }

    #[getter]
    fn frames(&self) -> u64 {
        self.job.frames()
    }

    #[getter]
    fn canonical(&self) -> &str {
        self.job.canonical()
    }

    #[getter]
    fn digest(&self) -> String {
        self.job.digest()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.job.warnings().to_vec()
    }

    /// The resolved parameters of a frame as JSON.
    fn resolve(&self, index: u64) -> PyResult<String> {
        Ok(self.frame(index)?.parameters.to_string())
    }

    /// The plan of a frame as JSON.
    fn plan(&self, py: Python<'_>, index: u64) -> PyResult<String> {
        let frame = self.frame(index)?;
        let mut slot = self.studio.take();
        let (slot, plan) = py.detach(|| {
            let plan = slot.plan(&frame, &SceneSource::Local);
            (slot, plan)
        });
        self.studio.keep(slot);
        let plan = plan.map_err(|error| render_error(py, index, error))?;
        Ok(json!({"plan": plan, "promise": plan.promise()}).to_string())
    }

    /// The arrays of a frame by kind, and its record as JSON. Without `kinds` those of the description; inputs of
    /// metrics are omitted unless requested.
    #[pyo3(signature = (index, kinds, metrics))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        index: u64,
        kinds: Option<Vec<String>>,
        metrics: bool,
    ) -> PyResult<(Vec<(String, Array<'py>)>, String)> {
        let mut frame = self.frame(index)?;
        if let Some(kinds) = kinds {
            frame.artifacts = kinds.iter().map(|name| kind(name)).collect::<PyResult<_>>()?;
        }
        if metrics {
            add_enhancements(&mut frame);
        } else {
            frame.metrics.clear();
            keep_enhancements(&mut frame);
        }
        let mut slot = self.studio.take();
        let (slot, rendered) = py.detach(|| {
            let rendered = slot.attempt_contents(&frame, &SceneSource::Local);
            (slot, rendered)
        });
        self.studio.keep(slot);
        let Contents { artifacts, record } = rendered.map_err(|error| render_error(py, index, error))?;
        if artifacts.len() < frame.artifacts.len() {
            let missing = record
                .warnings
                .iter()
                .filter(|text| text.starts_with("there is no artifact"));
            let missing: Vec<&str> = missing.map(String::as_str).collect();
            return Err(render_error(py, index, missing.join("; ")));
        }
        let arrays = artifacts
            .into_iter()
            .map(|(kind, content)| Ok((kind.to_string(), of_content(py, content)?)));
        Ok((arrays.collect::<PyResult<_>>()?, json!(record).to_string()))
    }
}

impl Job {
    fn frame(&self, index: u64) -> PyResult<Frame> {
        self.job
            .resolve(index)
            .map_err(|invalid| PyIndexError::new_err(invalid.to_string()))
    }
}

/// Keeps the enhancements that the requested artifacts need, and adds methods that only they name.
fn keep_enhancements(frame: &mut Frame) {
    let artifacts = &frame.artifacts;
    frame.enhance.retain(|enhancement| {
        let mut names = artifacts.iter().filter_map(ArtifactKind::enhancement);
        names.any(|(name, _)| name == enhancement.name)
    });
    add_enhancements(frame);
}

/// Adds the methods, with their defaults, that only the requested artifacts name.
fn add_enhancements(frame: &mut Frame) {
    for (name, _) in frame.artifacts.iter().filter_map(ArtifactKind::enhancement) {
        if frame.enhance.iter().all(|enhancement| enhancement.name != name) {
            frame.enhance.extend(Enhancement::of_method(name));
        }
    }
}

fn kind(name: &str) -> PyResult<ArtifactKind> {
    ArtifactKind::parse(name).ok_or_else(|| {
        let known: Vec<&str> = ArtifactKind::FIXED.iter().map(|(name, _)| *name).collect();
        PyValueError::new_err(format!(
            "artifact kind `{name}` does not exist; there is {}, enhanced.NAME",
            known.join(", ")
        ))
    })
}
