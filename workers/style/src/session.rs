//! One model on one thread.

use imaging::{Plane, Rgb};
use ort::environment::Environment;
use ort::session::builder::GraphOptimizationLevel;
use ort::value::{Tensor, TensorElementType, ValueType};

use crate::library::StyleModel;

/// A model that cannot run, or a picture that it cannot take.
#[derive(Debug, thiserror::Error)]
pub enum StyleError {
    /// The model cannot be read or has an unknown form.
    #[error("style `{name}`: {reason}")]
    Model {
        /// The model.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// A sample of the picture is no number.
    #[error("style `{name}`: the picture holds {value}, which is no number")]
    NotFinite {
        /// The model.
        name: String,
        /// The first such sample.
        value: f32,
    },
    /// The network answered something that is no picture of this frame.
    #[error("style `{name}`: the network answered {answer} for a frame of {width}×{height}")]
    Answer {
        /// The model.
        name: String,
        /// What it answered.
        answer: String,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
}

/// A model that is ready to run. It uses one thread: frames run side by side, each with its own session.
pub struct Session {
    name: String,
    session: ort::session::Session,
    image: String,
    noise: Option<String>,
    styled: String,
}

impl Session {
    pub(crate) fn new(environment: &Environment, model: &StyleModel) -> Result<Self, StyleError> {
        let wrong = |reason: String| StyleError::Model {
            name: model.name.clone(),
            reason,
        };
        let session = build(environment, &model.onnx).map_err(wrong)?;
        let inputs: Vec<&str> = session.inputs().iter().map(|input| input.name()).collect();
        let known = |name: &str| {
            inputs
                .iter()
                .find(|input| **input == name)
                .map(|input| (*input).to_owned())
        };
        let image = known("image").or_else(|| inputs.first().map(|input| (*input).to_owned()));
        let image = image.ok_or_else(|| wrong("it has no input".to_owned()))?;
        let noise = known("noise").filter(|noise| *noise != image);
        if let Some(other) = inputs
            .iter()
            .find(|input| **input != image && Some(**input) != noise.as_deref())
        {
            return Err(wrong(format!(
                "its input `{other}` is not known; it may have `image` and `noise`"
            )));
        }
        let kind = session
            .inputs()
            .iter()
            .find(|input| input.name() == image)
            .map(|input| input.dtype().clone());
        if !matches!(&kind, Some(ValueType::Tensor { ty: TensorElementType::Float32, shape, .. }) if shape.len() == 4)
        {
            return Err(wrong(format!(
                "its input `{image}` is no float32 tensor of four dimensions"
            )));
        }
        let outputs: Vec<&str> = session.outputs().iter().map(|output| output.name()).collect();
        let styled = outputs.iter().find(|name| **name == "styled").or(outputs.first());
        let styled = (*styled.ok_or_else(|| wrong("it has no output".to_owned()))?).to_owned();
        Ok(Self {
            name: model.name.clone(),
            session,
            image,
            noise,
            styled,
        })
    }

    /// Repaints an sRGB-encoded picture, values in 0..=1. A larger answer (a network that pads) is cropped from the top left.
    /// A model with a `noise` input gets zeros.
    ///
    /// # Errors
    /// [`StyleError`]: a sample that is no number, or an answer that is no picture of this size.
    pub fn apply(&mut self, encoded: &Rgb<f32>) -> Result<Rgb<f32>, StyleError> {
        let (width, height) = encoded.size();
        let name = self.name.clone();
        if let Some(&value) = encoded
            .planes()
            .iter()
            .flat_map(|plane| plane.data())
            .find(|value| !value.is_finite())
        {
            return Err(StyleError::NotFinite { name, value });
        }
        let failed = |error: ort::Error| StyleError::Model {
            name: name.clone(),
            reason: error.to_string(),
        };
        let samples: Vec<f32> = encoded
            .planes()
            .iter()
            .flat_map(|plane| plane.data().iter().copied())
            .collect();
        let image = Tensor::from_array(([1, 3, height, width], samples)).map_err(failed)?;
        let mut inputs = vec![(self.image.as_str(), image)];
        if let Some(noise) = &self.noise {
            let zeros =
                Tensor::from_array(([1, 1, height, width], vec![0.0f32; width * height])).map_err(failed)?;
            inputs.push((noise, zeros));
        }
        let outputs = self.session.run(inputs).map_err(failed)?;
        let answer = |answer: String| StyleError::Answer {
            name: name.clone(),
            answer,
            width,
            height,
        };
        let value = outputs
            .get(&self.styled)
            .ok_or_else(|| answer("nothing".to_owned()))?;
        let (shape, samples) = value
            .try_extract_tensor::<f32>()
            .map_err(|error| answer(error.to_string()))?;
        let [1, 3, rows, columns] = **shape else {
            return Err(answer(format!("a tensor of shape {shape}")));
        };
        let (rows, columns) = (rows as usize, columns as usize);
        if rows < height || columns < width {
            return Err(answer(format!("{columns}×{rows}")));
        }
        if let Some(value) = samples.iter().find(|value| !value.is_finite()) {
            return Err(answer(format!("{value}, which is no number")));
        }
        let plane = |channel: usize| {
            Plane::from_fn(width, height, |x, y| {
                samples[(channel * rows + y) * columns + x].clamp(0.0, 1.0)
            })
        };
        Ok(Rgb::new([plane(0), plane(1), plane(2)]).expect("three planes of one size"))
    }
}

fn build(environment: &Environment, onnx: &[u8]) -> Result<ort::session::Session, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let builder = ort::session::Session::builder(environment).map_err(|e| text(&e))?;
    let builder = builder.with_intra_threads(1).map_err(|e| text(&e))?;
    let builder = builder.with_inter_threads(1).map_err(|e| text(&e))?;
    let builder = builder.with_parallel_execution(false).map_err(|e| text(&e))?;
    let builder = builder.with_intra_op_spinning(false).map_err(|e| text(&e))?;
    let builder = builder.with_deterministic_compute(true).map_err(|e| text(&e))?;
    let mut builder = builder
        .with_optimization_level(GraphOptimizationLevel::Level3)
        .map_err(|e| text(&e))?;
    builder.commit_from_memory(onnx).map_err(|e| text(&e))
}
