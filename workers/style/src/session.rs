//! A model ready to run on one thread.

mod inputs;
mod onnx;

use imaging::Rgb;
use ort::environment::Environment;

use crate::error::StyleError;
use crate::library::StyleModel;
use crate::net::{self, ColorTable, Network, Scratch, TableScratch};

pub use inputs::ModelInputs;
use onnx::RuntimeGraph;
pub(crate) use onnx::options;

/// A model ready to run. It runs only on the calling thread: parallel frames need a session each. The same frame yields
/// the same bits: for the native network on every machine, for others on one build of ONNX Runtime and one set of CPU
/// features.
pub struct Session {
    name: String,
    form: SessionKind,
    /// The value of white for networks on ONNX Runtime.
    scale: f32,
}

enum SessionKind {
    /// The built-in architecture, natively.
    Native(Box<(Network, Scratch)>),
    /// The color table of the built-in architecture.
    Table(Box<(ColorTable, TableScratch)>),
    /// Any other network, on ONNX Runtime.
    Onnx(RuntimeGraph),
}

/// A repainted frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Repainted {
    /// sRGB-encoded samples in 0..=1.
    pub picture: Rgb<f32>,
    /// Samples of the network outside of 0..=1.
    pub clamped: u64,
}

impl Session {
    /// A session without ONNX Runtime: for the architecture of the shipped and locally trained waters, `None` for any
    /// other.
    #[must_use]
    pub fn native(model: &StyleModel) -> Option<Self> {
        let network = Network::new(&net::onnx::read(&model.onnx)?);
        Some(Self {
            name: model.name.clone(),
            form: SessionKind::Native(Box::new((network, Scratch::default()))),
            scale: 1.0,
        })
    }

    /// A session with the color table of the built-in architecture: several times faster, without softening and haze
    /// around edges. `None` for any other architecture and for models with a range.
    #[must_use]
    pub fn table(model: &StyleModel) -> Option<Self> {
        let table = ColorTable::new(&Network::new(&net::onnx::read(&model.onnx)?))?;
        Some(Self {
            name: model.name.clone(),
            form: SessionKind::Table(Box::new((table, TableScratch::default()))),
            scale: 1.0,
        })
    }

    pub(crate) fn onnx(environment: &Environment, model: &StyleModel) -> Result<Self, StyleError> {
        let graph = RuntimeGraph::new(environment, &model.onnx).map_err(|reason| StyleError::Model {
            name: model.name.clone(),
            reason,
        })?;
        Ok(Self {
            name: model.name.clone(),
            form: SessionKind::Onnx(graph),
            scale: model.card.scale.unwrap_or(1.0),
        })
    }

    /// Whether it runs on ONNX Runtime.
    #[must_use]
    pub fn uses_runtime(&self) -> bool {
        matches!(self.form, SessionKind::Onnx(_))
    }

    /// Whether the model has a noise input: supply [`crate::noise`].
    #[must_use]
    pub fn takes_noise(&self) -> bool {
        matches!(&self.form, SessionKind::Onnx(graph) if graph.takes_noise())
    }

    /// Whether the model has a range input: [`ModelInputs::range`] is required.
    #[must_use]
    pub fn takes_range(&self) -> bool {
        match &self.form {
            SessionKind::Native(native) => native.0.takes_range(),
            SessionKind::Table(_) => false,
            SessionKind::Onnx(graph) => graph.takes_range(),
        }
    }

    /// Repaints a frame of sRGB-encoded samples in 0..=1 and returns the same encoding, clamped. An output larger than the frame
    /// (of a network that pads) is cropped from the top left.
    ///
    /// # Errors
    /// [`StyleError`]: an empty frame, a missing required range, a non-finite sample, a network that fails, or an
    /// output that is not a picture, is smaller than the frame, or has a non-finite sample.
    pub fn apply(&mut self, encoded: &Rgb<f32>, beside: ModelInputs<'_>) -> Result<Rgb<f32>, StyleError> {
        self.repaint(encoded, beside).map(|repainted| repainted.picture)
    }

    /// As [`Session::apply`], with the number of clamped samples.
    ///
    /// # Errors
    /// Those of [`Session::apply`].
    pub fn repaint(&mut self, encoded: &Rgb<f32>, beside: ModelInputs<'_>) -> Result<Repainted, StyleError> {
        let mut picture = self.apply_unclamped(encoded, beside)?;
        let mut clamped = 0;
        // The native network clamps its own output.
        if self.uses_runtime() {
            for sample in picture.planes_mut().into_iter().flatten() {
                clamped += u64::from(!(0.0..=1.0).contains(sample));
                *sample = sample.clamp(0.0, 1.0);
            }
        }
        Ok(Repainted { picture, clamped })
    }

    /// As [`Session::apply`], with the samples of a network on ONNX Runtime as it returns them, divided by its scale.
    pub(crate) fn apply_unclamped(
        &mut self,
        encoded: &Rgb<f32>,
        beside: ModelInputs<'_>,
    ) -> Result<Rgb<f32>, StyleError> {
        self.check(encoded, beside)?;
        match &mut self.form {
            SessionKind::Native(native) => {
                let (network, scratch) = &mut **native;
                Ok(network.apply(encoded, beside.range, scratch))
            }
            SessionKind::Table(table) => {
                let (table, scratch) = &mut **table;
                Ok(table.apply(encoded, scratch))
            }
            SessionKind::Onnx(graph) => {
                run_scaled(graph, encoded, beside, self.scale).map_err(|reason| StyleError::Run {
                    name: self.name.clone(),
                    reason,
                })
            }
        }
    }

    fn check(&self, encoded: &Rgb<f32>, beside: ModelInputs<'_>) -> Result<(), StyleError> {
        let wrong = |reason: String| {
            Err(StyleError::Input {
                name: self.name.clone(),
                reason,
            })
        };
        let (width, height) = encoded.size();
        if width == 0 || height == 0 {
            return wrong(format!("the frame is empty: {width}×{height}"));
        }
        if self.takes_range() && beside.range.is_none() {
            return wrong("it needs the range of each pixel, but the frame has none".to_owned());
        }
        let noise = beside.noise.filter(|_| self.takes_noise());
        let range = beside.range.filter(|_| self.takes_range());
        let beside = [("noise", noise), ("range", range)];
        let beside = beside
            .into_iter()
            .filter_map(|(input, plane)| Some((input, plane?)));
        for (input, plane) in beside.clone() {
            let (columns, rows) = plane.size();
            if (columns, rows) != (width, height) {
                return wrong(format!(
                    "{input} is {columns}×{rows} but the frame is {width}×{height}"
                ));
            }
        }
        let planes = encoded.planes().iter().map(|plane| ("image", plane));
        for (input, plane) in planes.chain(beside) {
            if let Some(at) = plane.data().iter().position(|sample| !sample.is_finite()) {
                let (x, y, value) = (at % width, at / width, plane.data()[at]);
                return wrong(format!("{input} is {value} at pixel ({x}, {y}); must be finite"));
            }
        }
        Ok(())
    }
}

/// Runs a network whose inputs and outputs have this value of white.
fn run_scaled(
    graph: &mut RuntimeGraph,
    encoded: &Rgb<f32>,
    beside: ModelInputs<'_>,
    scale: f32,
) -> Result<Rgb<f32>, String> {
    if scale == 1.0 {
        return graph.run(encoded, beside);
    }
    let styled = graph.run(&encoded.map(|&sample| sample * scale), beside)?;
    Ok(styled.map(|&sample| sample / scale))
}
