//! Streams: pictures of a camera as arrays.

mod arrays;

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use renderer::{ChannelOrder, StreamError, StreamFrame, StreamInput, StreamOptions, Vary};
use serde_json::json;
use spec::FrameRecord;

use crate::arrays::{Array, of_content};
use crate::errors::{invalid_argument, invalid_job, render_error};
use crate::studio::Studio;
use arrays::{DepthArray, PictureArray};

/// A job over the pictures of a camera.
#[pyclass(frozen, module = "fathom._native")]
pub(crate) struct Stream {
    /// `None` while a thread renders a frame, so that no lock is held meanwhile.
    idle: Mutex<Option<renderer::Stream>>,
    warnings: Vec<String>,
}

/// The record of a frame, written as JSON on request.
#[pyclass(frozen, module = "fathom._native")]
pub(crate) struct StreamRecord(FrameRecord);

/// Arrays by kind, record, error bound and elapsed milliseconds.
type Outcome<'py> = (Vec<(String, Array<'py>)>, StreamRecord, Option<f64>, f64);

/// Rows of a matrix.
type Matrix<const SIDE: usize> = [[f64; SIDE]; SIDE];

#[pymethods]
impl StreamRecord {
    fn text(&self) -> String {
        json!(self.0).to_string()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }
}

#[pymethods]
impl Stream {
    #[new]
    fn new(
        py: Python<'_>,
        text: &str,
        vary: &str,
        has_metrics: bool,
        deadline_ms: Option<f64>,
        styles: Option<PathBuf>,
        onnxruntime: Option<PathBuf>,
    ) -> PyResult<Self> {
        let studio = Studio::open(styles.as_deref(), onnxruntime.as_deref())?;
        let options = StreamOptions {
            vary: match vary {
                "stream" => Vary::Stream,
                "frame" => Vary::Frame,
                _ => {
                    let message = format!("`vary` is \"{vary}\"; must be \"stream\" or \"frame\"");
                    return Err(invalid_argument(py, message));
                }
            },
            has_metrics,
            deadline_ms,
        };
        let opened = py.detach(|| renderer::Stream::open(text.as_bytes(), options, &studio.engine));
        let stream = opened.map_err(|invalid| invalid_job(py, &invalid))?;
        Ok(Self {
            warnings: stream.warnings().to_vec(),
            idle: Mutex::new(Some(stream)),
        })
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Renders a frame; `depth` has the name of its argument.
    #[expect(clippy::too_many_arguments, reason = "the arguments of the Python call")]
    #[pyo3(signature = (rgb, channels, depth, camera, stamp_ns, pose))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        rgb: &Array<'py>,
        channels: &str,
        depth: Option<(String, Array<'py>)>,
        camera: Option<Matrix<3>>,
        stamp_ns: Option<u64>,
        pose: Option<Matrix<4>>,
    ) -> PyResult<Outcome<'py>> {
        let refuse = |message| invalid_argument(py, message);
        let channels = read_channels(channels).map_err(refuse)?;
        let depth = depth.map(|(name, array)| DepthArray::read(&name, &array));
        let (picture, depth) = match (PictureArray::read(rgb, channels), depth.transpose()) {
            (Ok(picture), Ok(depth)) => (picture, depth),
            (picture, depth) => {
                let messages: Vec<String> = picture.err().into_iter().chain(depth.err()).collect();
                return Err(refuse(messages.join("; ")));
            }
        };
        let input = StreamInput {
            picture: picture.describe(channels),
            depth: depth.as_ref().map(DepthArray::describe),
            instances: None,
            camera,
            stamp_ns,
            pose,
        };
        let frame = self.run(py, &input)?;
        let bound = frame.error_bound();
        let arrays = frame
            .artifacts
            .into_iter()
            .map(|(kind, content)| Ok((kind.to_string(), of_content(py, content)?)));
        Ok((
            arrays.collect::<PyResult<_>>()?,
            StreamRecord(frame.record),
            bound,
            frame.elapsed_ms,
        ))
    }
}

impl Stream {
    /// Renders a frame detached from the interpreter.
    fn run(&self, py: Python<'_>, input: &StreamInput<'_>) -> PyResult<StreamFrame> {
        let mut stream = self.take()?;
        let stamp_ns = input.stamp_ns.unwrap_or(stream.frames());
        let (stream, rendered) = py.detach(|| {
            let rendered = stream.render(input);
            (stream, rendered)
        });
        *self.idle.lock().unwrap_or_else(PoisonError::into_inner) = Some(stream);
        rendered.map_err(|error| match error {
            StreamError::Input(_) => invalid_argument(py, error.to_string()),
            StreamError::Render(error) => render_error(py, stamp_ns, error),
        })
    }

    fn take(&self) -> PyResult<renderer::Stream> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).take();
        idle.ok_or_else(|| {
            PyRuntimeError::new_err(
                "the stream renders a frame in another thread; open one stream for each thread",
            )
        })
    }
}

fn read_channels(name: &str) -> Result<ChannelOrder, String> {
    ChannelOrder::parse(name).ok_or_else(|| {
        let known = ChannelOrder::ALL.map(|(name, _)| name).join(", ");
        format!("`channels` is \"{name}\"; must be one of {known}")
    })
}
