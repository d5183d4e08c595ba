//! A network of any architecture on ONNX Runtime.

use imaging::{Plane, Rgb};
use ort::environment::Environment;
use ort::session::builder::{GraphOptimizationLevel, SessionBuilder};
use ort::value::{Outlet, TensorElementType, TensorRef, ValueType};

use super::inputs::ModelInputs;

/// A loaded network and the names of its inputs and output.
pub(super) struct RuntimeGraph {
    session: ort::session::Session,
    ports: Ports,
    /// The frame as network input, `[1, 3, height, width]`; reused between frames.
    samples: Vec<f32>,
}

/// Names of the inputs and of the output.
struct Ports {
    image: String,
    noise: Option<String>,
    range: Option<String>,
    styled: String,
}

impl RuntimeGraph {
    pub(super) fn new(environment: &Environment, onnx: &[u8]) -> Result<Self, String> {
        let mut builder = options(environment).map_err(|error| error.to_string())?;
        let session = builder
            .commit_from_memory(onnx)
            .map_err(|error| error.to_string())?;
        let ports = Ports::find(session.inputs(), session.outputs())?;
        Ok(Self {
            session,
            ports,
            samples: Vec::new(),
        })
    }

    pub(super) fn takes_noise(&self) -> bool {
        self.ports.noise.is_some()
    }

    pub(super) fn takes_range(&self) -> bool {
        self.ports.range.is_some()
    }

    /// Runs a checked frame. The error describes the failure.
    pub(super) fn run(&mut self, encoded: &Rgb<f32>, beside: ModelInputs<'_>) -> Result<Rgb<f32>, String> {
        let (width, height) = encoded.size();
        self.samples.clear();
        for plane in encoded.planes() {
            self.samples.extend_from_slice(plane.data());
        }
        let Self {
            session,
            ports,
            samples,
        } = self;
        let failed = |error: ort::Error| format!("failed on a frame of {width}×{height}: {error}");
        let image =
            TensorRef::from_array_view(([1, 3, height, width], samples.as_slice())).map_err(failed)?;
        let mut inputs = vec![(ports.image.as_str(), image)];
        let given = [(&ports.noise, beside.noise), (&ports.range, beside.range)];
        let zeros = if given
            .iter()
            .any(|(port, plane)| port.is_some() && plane.is_none())
        {
            vec![0.0; width * height]
        } else {
            Vec::new()
        };
        for (port, plane) in given {
            let Some(port) = port else { continue };
            let plane = plane.map_or(zeros.as_slice(), Plane::data);
            let plane = TensorRef::from_array_view(([1, 1, height, width], plane)).map_err(failed)?;
            inputs.push((port, plane));
        }
        let outputs = session.run(inputs).map_err(failed)?;
        let (shape, styled) = outputs[ports.styled.as_str()]
            .try_extract_tensor::<f32>()
            .map_err(failed)?;
        cropped(shape, styled, width, height)
            .map_err(|output| format!("returned {output} for a {width}×{height} frame"))
    }
}

/// One thread, no spinning, sequential operators and deterministic kernels.
pub(crate) fn options(environment: &Environment) -> ort::Result<SessionBuilder> {
    Ok(SessionBuilder::new(environment)?
        .with_intra_threads(1)?
        .with_inter_threads(1)?
        .with_parallel_execution(false)?
        .with_intra_op_spinning(false)?
        .with_inter_op_spinning(false)?
        .with_deterministic_compute(true)?
        .with_optimization_level(GraphOptimizationLevel::All)?)
}

impl Ports {
    /// Finds the inputs `image`, `noise` and `range` and the output `styled` by name. A single input or a first output
    /// of another name serves as `image` or `styled`.
    fn find(inputs: &[Outlet], outputs: &[Outlet]) -> Result<Self, String> {
        let [noise, range] =
            ["noise", "range"].map(|name| position(inputs, name).filter(|_| inputs.len() > 1));
        let mut others = (0..inputs.len()).filter(|&input| Some(input) != noise && Some(input) != range);
        let image = position(inputs, "image").or_else(|| others.clone().next());
        let image = image.ok_or("it has no input")?;
        if let Some(unknown) = others.find(|&input| input != image) {
            let unknown = inputs[unknown].name();
            return Err(format!(
                "its input `{unknown}` is unknown; it may have `image`, `noise` and `range`"
            ));
        }
        let styled = position(outputs, "styled").unwrap_or(0);
        let styled = outputs.get(styled).ok_or("it has no output")?;
        check_kind(&inputs[image], 3)?;
        check_kind(styled, 3)?;
        for beside in [noise, range].into_iter().flatten() {
            check_kind(&inputs[beside], 1)?;
        }
        Ok(Self {
            image: inputs[image].name().to_owned(),
            noise: noise.map(|noise| inputs[noise].name().to_owned()),
            range: range.map(|range| inputs[range].name().to_owned()),
            styled: styled.name().to_owned(),
        })
    }
}

/// Rejects anything but float32 of shape `[n, channels, h, w]`, where each may be dynamic (-1).
fn check_kind(outlet: &Outlet, channels: i64) -> Result<(), String> {
    if let ValueType::Tensor {
        ty: TensorElementType::Float32,
        shape,
        ..
    } = outlet.dtype()
        && let [n, c, _, _] = **shape
        && (n == 1 || n < 0)
        && (c == channels || c < 0)
    {
        return Ok(());
    }
    let (name, kind) = (outlet.name(), outlet.dtype());
    Err(format!(
        "`{name}` is {kind}; must be float32 of shape [1, {channels}, height, width]"
    ))
}

/// The top left of the output.
fn cropped(shape: &[i64], samples: &[f32], width: usize, height: usize) -> Result<Rgb<f32>, String> {
    let [1, 3, rows, columns] = *shape else {
        return Err(format!("a tensor of shape {shape:?}"));
    };
    let (rows, columns) = (rows as usize, columns as usize);
    if rows < height || columns < width {
        return Err(format!("a picture of {columns}×{rows}"));
    }
    let plane = |channel: usize| {
        let mut data = Vec::with_capacity(width * height);
        let rows = samples[channel * rows * columns..]
            .chunks_exact(columns)
            .take(height);
        for row in rows {
            if let Some(value) = row[..width].iter().find(|value| !value.is_finite()) {
                return Err(format!("a picture with a sample of {value}"));
            }
            data.extend_from_slice(&row[..width]);
        }
        Plane::new(width, height, data).map_err(|error| error.to_string())
    };
    Rgb::new([plane(0)?, plane(1)?, plane(2)?]).map_err(|error| error.to_string())
}

fn position(outlets: &[Outlet], name: &str) -> Option<usize> {
    outlets.iter().position(|outlet| outlet.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_larger_answer_is_cropped_from_the_top_left() {
        let samples: Vec<f32> = (0..18).map(|i| i as f32 / 10.0 - 0.1).collect();
        let picture = cropped(&[1, 3, 2, 3], &samples, 2, 1).unwrap();
        assert_eq!(picture.planes()[0].data(), &[samples[0], samples[1]]);
        assert_eq!(picture.planes()[1].data(), &[samples[6], samples[7]]);
        assert_eq!(picture.planes()[2].data(), &[samples[12], samples[13]]);
    }

    #[test]
    fn an_answer_that_is_no_picture_of_the_frame_is_refused() {
        let refused = |shape: &[i64], samples: &[f32]| cropped(shape, samples, 2, 1).unwrap_err();
        assert_eq!(refused(&[1, 3, 1, 1], &[0.5; 3]), "a picture of 1×1");
        assert_eq!(
            refused(&[1, 1, 1, 2], &[0.5; 2]),
            "a tensor of shape [1, 1, 1, 2]"
        );
        assert_eq!(refused(&[3, 1, 2], &[0.5; 6]), "a tensor of shape [3, 1, 2]");
        let samples = [0.5, 0.5, 0.5, f32::NAN, 0.5, 0.5];
        assert_eq!(refused(&[1, 3, 1, 2], &samples), "a picture with a sample of NaN");
    }
}
