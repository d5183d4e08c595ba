//! Streams: pictures of a camera as arrays.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use renderer::{
    ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamError, StreamFrame, StreamInput,
    StreamOptions, StreamPicture, Vary,
};
use serde_json::json;
use spec::{FrameRecord, RangeKind};

use crate::arrays::{Array, of_content};
use crate::errors::{invalid_argument, invalid_job, render_error};
use crate::studio::Studio;

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
        let (samples, distances) = (picture.samples(), depth.as_ref().map(DepthArray::samples));
        let input = StreamInput {
            picture: StreamPicture {
                size: picture.size,
                channels,
                samples: samples.borrow(),
            },
            depth: depth
                .as_ref()
                .zip(distances.as_ref())
                .map(|(depth, samples)| StreamDepth {
                    kind: depth.kind,
                    size: depth.size,
                    samples: samples.borrow(),
                }),
            camera,
            stamp_ns,
            pose,
        };
        let mut stream = self.take()?;
        let (stream, rendered) = py.detach(|| {
            let rendered = stream.render(&input);
            (stream, rendered)
        });
        *self.idle.lock().unwrap_or_else(PoisonError::into_inner) = Some(stream);
        let StreamFrame {
            artifacts,
            record,
            elapsed_ms,
        } = rendered.map_err(|error| match error {
            StreamError::Input(_) => invalid_argument(py, error.to_string()),
            StreamError::Render(error) => render_error(py, stamp_ns.unwrap_or_default(), error),
        })?;
        let bound = record.promise.as_ref().map(|promise| promise.bound);
        let arrays = artifacts
            .into_iter()
            .map(|(kind, content)| Ok((kind.to_string(), of_content(py, content)?)));
        Ok((
            arrays.collect::<PyResult<_>>()?,
            StreamRecord(record),
            bound,
            elapsed_ms,
        ))
    }
}

impl Stream {
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

/// An array in the order of its indices: borrowed if its memory has this order.
fn in_order<'a, T: Element + Copy>(array: &'a PyReadonlyArrayDyn<'_, T>) -> Cow<'a, [T]> {
    match array.as_slice() {
        Ok(samples) => Cow::Borrowed(samples),
        Err(_) => Cow::Owned(array.as_array().iter().copied().collect()),
    }
}

/// The shape of an array of an argument.
fn read_shape(name: &str, given: &Array<'_>) -> Result<Vec<usize>, String> {
    match given.cast::<PyUntypedArray>() {
        Ok(array) => Ok(array.shape().to_vec()),
        Err(_) => {
            let kind = given.get_type().name();
            let kind = kind.map_or_else(|_| String::new(), |name| name.to_string());
            Err(format!("`{name}` is a {kind}; must be a NumPy array"))
        }
    }
}

fn describe_type(given: &Array<'_>) -> String {
    let array = given.cast::<PyUntypedArray>();
    array.map_or_else(|_| String::new(), |array| array.dtype().to_string())
}

/// Sizes as Python writes them.
fn describe_shape(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", sides.join(", "))
}

/// The picture of a call.
struct PictureArray<'py> {
    size: (usize, usize),
    held: PictureHeld<'py>,
}

enum PictureHeld<'py> {
    Srgb(PyReadonlyArrayDyn<'py, u8>),
    Linear(PyReadonlyArrayDyn<'py, f32>),
}

enum PictureCow<'a> {
    Srgb(Cow<'a, [u8]>),
    Linear(Cow<'a, [f32]>),
}

impl PictureCow<'_> {
    fn borrow(&self) -> PictureSamples<'_> {
        match self {
            Self::Srgb(samples) => PictureSamples::Srgb(samples),
            Self::Linear(samples) => PictureSamples::Linear(samples),
        }
    }
}

impl<'py> PictureArray<'py> {
    fn read(given: &Array<'py>, channels: ChannelOrder) -> Result<Self, String> {
        let shape = read_shape("rgb", given)?;
        let size = match *shape {
            [height, width] if channels == ChannelOrder::Mono => (width, height),
            [height, width, count] if count == channels.count() => (width, height),
            _ => {
                let needed = match channels {
                    ChannelOrder::Mono => "(height, width)".to_owned(),
                    _ => format!("(height, width, {})", channels.count()),
                };
                return Err(format!(
                    "`rgb` has the shape {}; must be {needed} with `channels` \"{}\"",
                    describe_shape(&shape),
                    channels.name()
                ));
            }
        };
        let held = if let Ok(codes) = given.extract() {
            PictureHeld::Srgb(codes)
        } else if let Ok(light) = given.extract() {
            PictureHeld::Linear(light)
        } else {
            return Err(format!(
                "`rgb` has the dtype {}; must be uint8 (sRGB codes) or float32 (linear light)",
                describe_type(given)
            ));
        };
        Ok(Self { size, held })
    }

    fn samples(&self) -> PictureCow<'_> {
        match &self.held {
            PictureHeld::Srgb(codes) => PictureCow::Srgb(in_order(codes)),
            PictureHeld::Linear(light) => PictureCow::Linear(in_order(light)),
        }
    }
}

/// The distances of a call.
struct DepthArray<'py> {
    kind: RangeKind,
    size: (usize, usize),
    held: DepthHeld<'py>,
}

enum DepthHeld<'py> {
    Meters(PyReadonlyArrayDyn<'py, f32>),
    Millimeters(PyReadonlyArrayDyn<'py, u16>),
}

enum DepthCow<'a> {
    Meters(Cow<'a, [f32]>),
    Millimeters(Cow<'a, [u16]>),
}

impl DepthCow<'_> {
    fn borrow(&self) -> DepthSamples<'_> {
        match self {
            Self::Meters(samples) => DepthSamples::Meters(samples),
            Self::Millimeters(samples) => DepthSamples::Millimeters(samples),
        }
    }
}

impl<'py> DepthArray<'py> {
    fn read(name: &str, given: &Array<'py>) -> Result<Self, String> {
        let shape = read_shape(name, given)?;
        let ([height, width] | [height, width, 1]) = *shape else {
            let shape = describe_shape(&shape);
            return Err(format!("`{name}` has the shape {shape}; must be (height, width)"));
        };
        let held = if let Ok(meters) = given.extract() {
            DepthHeld::Meters(meters)
        } else if let Ok(codes) = given.extract() {
            DepthHeld::Millimeters(codes)
        } else {
            return Err(format!(
                "`{name}` has the dtype {}; must be float32 (meters) or uint16 (millimeters)",
                describe_type(given)
            ));
        };
        Ok(Self {
            kind: if name == "z_depth" {
                RangeKind::ZDepth
            } else {
                RangeKind::Range
            },
            size: (width, height),
            held,
        })
    }

    fn samples(&self) -> DepthCow<'_> {
        match &self.held {
            DepthHeld::Meters(meters) => DepthCow::Meters(in_order(meters)),
            DepthHeld::Millimeters(codes) => DepthCow::Millimeters(in_order(codes)),
        }
    }
}
