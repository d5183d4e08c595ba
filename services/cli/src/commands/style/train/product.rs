//! The files of a training: the network, its card and its sheet.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::codec;
use style::net::{Network, onnx};
use style::{LossTerms, ModelCard, ModelRole, TrainingCard};
use training::loss::Losses;
use training::{Best, Score};

use super::arguments::{Arguments, Given};
use super::{distance, sheet};

/// A network that changes less than this beyond its color map has learned no texture.
const LEAST_BRANCH: f64 = 1.0;

/// The input of a training's files.
pub(super) struct Product<'a> {
    pub(super) arguments: &'a Arguments,
    pub(super) given: &'a [Given],
    /// Score of the color transfer alone.
    pub(super) start: Score,
}

impl Product<'_> {
    /// The path of NAME.EXTENSION.
    pub(super) fn path(&self, extension: &str) -> PathBuf {
        let file = format!("{}.{extension}", self.arguments.name);
        self.arguments.out.join(file)
    }

    /// Writes all three files or none.
    pub(super) fn write(&self, best: &Best, score: Score, done: usize) -> Result<(), Failure> {
        let Arguments {
            name, seed, steps, ..
        } = self.arguments;
        let digests: Vec<_> = self.given.iter().map(|given| given.sha256.as_str()).collect();
        let (seed, steps, digests) = (seed.to_string(), steps.to_string(), digests.join(" "));
        let metadata = [
            ("name", name.as_str()),
            ("photo_sha256", &digests),
            ("seed", &seed),
            ("steps", &steps),
            ("kept_step", &best.step.to_string()),
        ];
        let model = onnx::write(&best.weights, &metadata);
        let card = self.card(&model, best, score, done);
        let mut text = serde_json::to_string_pretty(&card).context("cannot write the card")?;
        text.push('\n');
        let photos: Vec<_> = self.given.iter().map(|given| &given.picture).collect();
        let sheet = sheet::draw(&photos, &Network::new(&best.weights))?;
        let sheet = codec::encode_png(&sheet.into()).context("cannot encode the sheet")?;
        files::write_all(&[
            (self.path("sheet.png"), &sheet),
            (self.path("onnx"), &model),
            (self.path("card.json"), text.as_bytes()),
        ])
    }

    fn card(&self, model: &[u8], best: &Best, score: Score, done: usize) -> ModelCard {
        let Arguments {
            name, seed, steps, ..
        } = self.arguments;
        let mut caveats = vec!["paints no discrete particles".to_owned()];
        if best.step == 0 {
            caveats.push("the color transfer alone: no network was trained".to_owned());
        } else if score.branch < LEAST_BRANCH {
            caveats.push("the network adds almost nothing to its color map".to_owned());
        }
        if best.step > 0 && done < *steps as usize {
            caveats.push(format!("training was stopped after {done} of {steps} steps"));
        }
        ModelCard {
            scale: None,
            role: ModelRole::Style,
            input_scale: None,
            layout: None,
            size: None,
            name: name.clone(),
            file: format!("{name}.onnx"),
            sha256: imaging::digest::sha256(model),
            architecture: architecture(best.weights.takes_range()).to_owned(),
            parameters: Some(best.weights.values().len() as u64),
            source: self.arguments.source.clone(),
            licence: self.arguments.licence.clone(),
            inputs: inputs(best.weights.takes_range()),
            outputs: vec!["styled: [n,3,h,w] float32, sRGB-encoded, 0..1, the size of the input".to_owned()],
            takes_noise: false,
            takes_range: best.weights.takes_range(),
            alpha: "share of this output in the frame, blended in sRGB-encoded values: 0 leaves the network out, 1 is \
                    its output alone"
                .to_owned(),
            caveats,
            training: Some(TrainingCard {
                photos: self.given.iter().map(|given| given.sha256.clone()).collect(),
                seed: *seed,
                steps: *steps as usize,
                kept_step: best.step,
                losses: parts(&best.losses),
                held_out: parts(&score.losses),
                held_out_color_transfer: parts(&self.start.losses),
                branch_rms_255: rounded(score.branch),
                code_version: env!("CARGO_PKG_VERSION").to_owned(),
            }),
            table: distance::measure(&best.weights),
        }
    }
}

fn architecture(takes_range: bool) -> &'static str {
    if takes_range {
        "a context branch at quarter resolution, a thin branch at full resolution and an affine color map; the last two see \
         the range; opset 17, fp32"
    } else {
        "a context branch at quarter resolution, a thin branch at full resolution and an affine color map; opset 17, fp32"
    }
}

fn inputs(takes_range: bool) -> Vec<String> {
    let mut inputs = vec!["image: [n,3,h,w] float32, sRGB-encoded, 0..1, any size from 1x1".to_owned()];
    if takes_range {
        let scale = style::RANGE_SCALE_M;
        inputs.push(format!(
            "range: [n,1,h,w] float32, 1 - exp(-Z / {scale} m) of the range Z, 1 where there is no surface"
        ));
    }
    inputs
}

fn parts(losses: &Losses) -> LossTerms {
    LossTerms {
        texture: rounded(losses.texture),
        color: rounded(losses.color),
        content: rounded(losses.content),
    }
}

/// Rounds to four decimals; more would be noise on a card.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
