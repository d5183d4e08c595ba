//! `fathom child check-style`: tries an unverified network, for the service.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;
use cli::styles::StyleArguments;
use serde::de::DeserializeOwned;
use style::{InputScale, Layout, ModelRole, Runtime, SizeRule, StyleModel, Unfit};

/// Options of `fathom child check-style`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The ONNX file
    #[arg(long)]
    model: PathBuf,
    /// Its name
    #[arg(long)]
    name: String,
    /// The value of white in its inputs and outputs
    #[arg(long)]
    scale: Option<f32>,
    /// Its use in jobs
    #[arg(long, default_value = "style", value_parser = parse_word::<ModelRole>)]
    role: ModelRole,
    /// Enhancers and metrics only: the values of black and white
    #[arg(long, default_value = "0..1", value_parser = parse_word::<InputScale>, allow_hyphen_values = true)]
    input_scale: InputScale,
    /// Enhancers and metrics only: the order of the axes
    #[arg(long, default_value = "NCHW", value_parser = parse_word::<Layout>)]
    layout: Layout,
    /// Enhancers and metrics only: the sizes that it takes
    #[arg(long, default_value = "any", value_parser = parse_word::<SizeRule>)]
    size: SizeRule,
    #[command(flatten)]
    style: StyleArguments,
}

/// A word as in a card.
fn parse_word<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_value(text.into()).map_err(|error| error.to_string())
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.model;
    let onnx = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut model = StyleModel::without_card(&arguments.name, onnx);
    let card = &mut model.card;
    card.role = arguments.role;
    if card.role == ModelRole::Style {
        card.scale = arguments.scale;
    } else {
        card.input_scale = Some(arguments.input_scale);
        card.layout = Some(arguments.layout);
        card.size = Some(arguments.size);
    }
    let runtime = || Runtime::load(arguments.style.onnxruntime.as_deref());
    style::check(&model, runtime).map_err(|unfit| match unfit {
        Unfit::Runtime(missing) => Failure::RuntimeMissing(missing.to_string()),
        other => Failure::BadInput(other.to_string()),
    })
}
