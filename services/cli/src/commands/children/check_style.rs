//! `fathom child check-style`: tries an unverified style network, for the service.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;
use cli::styles::StyleArguments;
use style::{Runtime, StyleModel, Unfit};

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
    #[command(flatten)]
    style: StyleArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.model;
    let onnx = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut model = StyleModel::without_card(&arguments.name, onnx);
    model.card.scale = arguments.scale;
    let runtime = || Runtime::load(arguments.style.onnxruntime.as_deref());
    style::check(&model, runtime).map_err(|unfit| match unfit {
        Unfit::Runtime(missing) => Failure::RuntimeMissing(missing.to_string()),
        other => Failure::BadInput(other.to_string()),
    })
}
