//! Enhancers and metrics: networks that take an 8-bit picture, on ONNX Runtime.

mod port;
mod samples;

use imaging::Rgb8;
use ort::environment::Environment;
use ort::value::TensorRef;

use crate::library::StyleModel;
use crate::role::{ModelRole, PictureInput};
use crate::session::options;
use port::Ports;
use samples::{Output, fill, read};

/// A network that cannot run on a picture. Deterministic: a retry does not help.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("network `{name}` {reason}")]
pub struct NetworkError {
    /// Its name.
    pub name: String,
    /// Cause.
    pub reason: String,
}

/// An enhancer or a metric, ready to run on the calling thread. The same picture yields the same bits on one build of ONNX Runtime
/// and one set of CPU features.
pub struct PictureNetwork {
    name: String,
    input: PictureInput,
    session: ort::session::Session,
    ports: Ports,
    /// The picture as network input; reused between pictures.
    samples: Vec<f32>,
}

impl PictureNetwork {
    pub(crate) fn new(environment: &Environment, model: &StyleModel) -> Result<Self, NetworkError> {
        let role = model.card.role;
        let wrong = |reason: String| NetworkError {
            name: model.name.clone(),
            reason: format!("cannot be used: {reason}"),
        };
        if role == ModelRole::Style {
            return Err(wrong("it is a style; use it as `water.style`".to_owned()));
        }
        let input = model.card.picture_input();
        let session = options(environment).and_then(|mut builder| builder.commit_from_memory(&model.onnx));
        let session = session.map_err(|error| wrong(error.to_string()))?;
        let ports = Ports::find(session.inputs(), session.outputs(), role, input.layout).map_err(wrong)?;
        Ok(Self {
            name: model.name.clone(),
            input,
            session,
            ports,
            samples: Vec::new(),
        })
    }

    /// Enhances a picture of sRGB codes.
    ///
    /// # Errors
    /// [`NetworkError`]: an empty picture, one of a size that it does not take, a network that fails, or an output that is not a
    /// finite picture of the same size.
    pub fn enhance(&mut self, picture: &Rgb8) -> Result<Rgb8, NetworkError> {
        let values = self.enhance_unclamped(picture)?;
        let codes = values
            .iter()
            .map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8);
        Rgb8::new(picture.width(), picture.height(), codes.collect())
            .map_err(|error| self.error(format!("returned a wrong picture: {error}")))
    }

    /// As [`PictureNetwork::enhance`], with the network's values in 0 to 1, not clamped, three for each pixel.
    pub(crate) fn enhance_unclamped(&mut self, picture: &Rgb8) -> Result<Vec<f32>, NetworkError> {
        let input = self.input;
        let size = (picture.width(), picture.height());
        self.run(picture, |output, padded| read(output, padded, size, input))
    }

    /// The metric of a picture of sRGB codes.
    ///
    /// # Errors
    /// [`NetworkError`]: an empty picture, one of a size that it does not take, a network that fails, or an output that is not one
    /// finite number.
    pub fn measure(&mut self, picture: &Rgb8) -> Result<f64, NetworkError> {
        self.run(picture, |Output { shape, values }, _| match values {
            [value] if value.is_finite() => Ok(f64::from(*value)),
            [value] => Err(format!("{value}; must be a finite number")),
            _ => Err(format!("a tensor of shape {shape:?}; must be one number")),
        })
    }

    fn run<T>(
        &mut self,
        picture: &Rgb8,
        interpret: impl FnOnce(Output<'_>, (usize, usize)) -> Result<T, String>,
    ) -> Result<T, NetworkError> {
        let (width, height) = (picture.width(), picture.height());
        if width == 0 || height == 0 {
            return Err(self.error(format!(
                "needs a picture of at least 1×1, but it is {width}×{height}"
            )));
        }
        let (columns, rows) = self
            .input
            .size
            .padded(width, height)
            .map_err(|reason| self.error(reason))?;
        fill(&mut self.samples, picture, (columns, rows), self.input);
        let result = self.run_samples((columns, rows), interpret);
        result.map_err(|reason| self.error(format!("{reason} for a {width}×{height} picture")))
    }

    fn run_samples<T>(
        &mut self,
        (columns, rows): (usize, usize),
        interpret: impl FnOnce(Output<'_>, (usize, usize)) -> Result<T, String>,
    ) -> Result<T, String> {
        let failed = |error: ort::Error| format!("failed: {},", error.to_string().replace('\n', " "));
        let shape = self.input.layout.shape(columns, rows);
        let image = TensorRef::from_array_view((shape, self.samples.as_slice())).map_err(failed)?;
        let outputs = self
            .session
            .run(vec![(self.ports.image.as_str(), image)])
            .map_err(failed)?;
        let (shape, values) = outputs[self.ports.output.as_str()]
            .try_extract_tensor::<f32>()
            .map_err(failed)?;
        interpret(Output { shape, values }, (columns, rows)).map_err(|output| format!("returned {output}"))
    }

    fn error(&self, reason: String) -> NetworkError {
        NetworkError {
            name: self.name.clone(),
            reason,
        }
    }
}
