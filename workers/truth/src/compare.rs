//! Distance of a model from the truth, with its uncertainty.

use imaging::{Plane, Rgb};
use optics::range::is_hole;
use serde::{Serialize, Serializer};

use crate::estimate::{Estimate, LightPart, PixelBlocks};

/// Values below this many standard errors are not measured.
const LEAST: f64 = 2.0;
/// A block is resolved if its error exceeds its noise and this share of the truth.
const RESOLVED: f64 = 0.02;
/// Neighbors whose ranges differ by more than this factor form an occlusion edge.
const EDGE: f64 = 1.25;
/// Half the width of a 95 % interval in standard errors.
const CONFIDENCE: f64 = 1.96;

/// A number that may be hidden by noise. A hidden one is not 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeasuredValue {
    /// MeasuredValue value.
    Value(f64),
    /// It is below twice its standard error.
    NotMeasured,
}

impl MeasuredValue {
    fn new(value: f64, error: f64) -> Self {
        if value.is_finite() && value.abs() >= LEAST * error {
            Self::Value(value)
        } else {
            Self::NotMeasured
        }
    }

    fn relative_to(self, mean: f64) -> Self {
        match self {
            Self::Value(value) if mean > 0.0 => Self::Value(value / mean),
            _ => Self::NotMeasured,
        }
    }
}

impl Serialize for MeasuredValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Value(value) => serializer.serialize_f64(*value),
            Self::NotMeasured => serializer.serialize_str("not measured"),
        }
    }
}

/// The error e = model − truth over some blocks of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockDifference {
    /// Number of blocks.
    pub blocks: usize,
    /// Mean of the truth.
    pub truth: f64,
    /// Mean of the model.
    pub model: f64,
    /// Mean of e.
    pub bias: MeasuredValue,
    /// Half the width of the 95 % interval about the bias.
    pub confidence: f64,
    /// The bias over the mean of the truth.
    pub relative_bias: MeasuredValue,
    /// Root of the mean of e² less that of the noise.
    pub rms: MeasuredValue,
    /// RMS of e after subtracting the noise variance.
    pub relative_rms: MeasuredValue,
    /// Share of the blocks with |e| above twice their noise and 2 % of the truth.
    pub resolved: f64,
}

/// Comparison of a model with the truth, red, green and blue; `None` without such blocks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// PixelBlocks inside surfaces or open water.
    pub smooth: Option<[BlockDifference; 3]>,
    /// PixelBlocks crossed by an occlusion edge.
    pub edges: Option<[BlockDifference; 3]>,
}

impl Comparison {
    /// Compares linear light pixel by pixel, averaged over blocks of `side` pixels.
    #[must_use]
    pub fn new(
        model: &Rgb<f32>,
        truth: &Estimate,
        part: LightPart,
        range: Option<&Plane<f32>>,
        side: usize,
    ) -> Self {
        let blocks = PixelBlocks {
            size: truth.size,
            side,
        };
        let (edges, smooth): (Vec<_>, Vec<_>) = blocks
            .pixels()
            .partition(|block| range.is_some_and(|range| has_edge(range, block)));
        let [smooth, edges] = [smooth, edges].map(|blocks| {
            (!blocks.is_empty())
                .then(|| [0, 1, 2].map(|channel| difference(model, truth, part, channel, &blocks)))
        });
        Self { smooth, edges }
    }
}

fn difference(
    model: &Rgb<f32>,
    truth: &Estimate,
    part: LightPart,
    channel: usize,
    blocks: &[Vec<usize>],
) -> BlockDifference {
    let n = blocks.len() as f64;
    let samples = model.planes()[channel].data();
    let (mut mean, mut own, mut noise, mut square, mut resolved) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for block in blocks {
        let level = truth.mean(block, channel, part);
        let value = block.iter().map(|&i| f64::from(samples[i])).sum::<f64>() / block.len() as f64;
        let error = value - level.mean;
        mean += level.mean / n;
        own += value / n;
        noise += level.error * level.error / n;
        square += error * error / n;
        let is_resolved = error.abs() > LEAST * level.error + RESOLVED * level.mean;
        resolved += f64::from(u8::from(is_resolved)) / n;
    }
    let bias_error = (noise / n).sqrt();
    let bias = MeasuredValue::new(own - mean, bias_error);
    // The mean square of pure noise has a relative spread of √(2/n).
    let hidden = noise * (1.0 + LEAST * (2.0 / n).sqrt());
    let rms = if square > hidden {
        MeasuredValue::Value((square - noise).sqrt())
    } else {
        MeasuredValue::NotMeasured
    };
    BlockDifference {
        blocks: blocks.len(),
        truth: mean,
        model: own,
        bias,
        confidence: CONFIDENCE * bias_error,
        relative_bias: bias.relative_to(mean),
        rms,
        relative_rms: rms.relative_to(mean),
        resolved,
    }
}

/// Whether two neighbors inside the block form an occlusion edge.
fn has_edge(range: &Plane<f32>, block: &[usize]) -> bool {
    let width = range.width();
    block.iter().any(|&i| {
        let has_right = (i + 1) % width != 0;
        let neighbors = [has_right.then_some(i + 1), Some(i + width)];
        neighbors.into_iter().flatten().any(|other| {
            block.binary_search(&other).is_ok() && are_apart(range.data()[i], range.data()[other])
        })
    })
}

fn are_apart(a: f32, b: f32) -> bool {
    !is_hole(a) && !is_hole(b) && f64::from(a.max(b)) > EDGE * f64::from(a.min(b))
}
