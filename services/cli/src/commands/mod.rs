//! One file for each command.

mod backup;
mod bench;
mod campaign;
mod chart;
mod check_style;
mod demo;
mod enhance;
mod export;
mod figure;
mod ladder;
mod measure;
mod plan;
mod query;
mod render;
mod rerender;
mod scrub;
mod serve;
mod sheet;
mod stability;
mod style_photo;
mod styles;
mod submit;
mod table1;
mod train;
mod upload;
mod waters;
mod worker;

use std::path::PathBuf;

use crate::exit::Failure;

/// What `fathom` can do.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Start the service with its own workers
    Serve(serve::Arguments),
    /// Pull frames from a service and render them
    Worker(worker::Arguments),
    /// Render a job here, without a service
    Render(render::Arguments),
    /// Show what a frame would be rendered with, and how wrong that may be
    Plan(plan::Arguments),
    /// Submit a job to a service
    Submit(submit::Arguments),
    /// Ask for images by their parameters and metrics
    Query(query::Arguments),
    /// Write a dataset as a folder for training scripts
    Export(export::Arguments),
    /// Upload a scene: a picture with its range
    Upload(upload::Arguments),
    /// Read everything that a stopped service has stored, and render again what is damaged
    Scrub(scrub::Arguments),
    /// Copy everything that a running service has stored
    Backup(backup::Arguments),
    /// Write a contact sheet of a dataset
    Sheet(sheet::Arguments),
    /// Enhance a picture
    Enhance(enhance::Arguments),
    /// Measure the quality of pictures
    Measure(measure::Arguments),
    /// Compare the enhancement methods over a folder of pictures or a dataset
    Table1(table1::Arguments),
    /// Map where methods fail
    Stability(stability::Arguments),
    /// Show what each effect of the chain buys in a water
    Ladder(ladder::Arguments),
    /// Try random frames against the promise of the plan
    Campaign(campaign::Arguments),
    /// Draw error against time of the variants of each stage
    Chart(chart::Arguments),
    /// List the optical water presets
    Waters(waters::Arguments),
    /// List the style waters
    Styles(styles::Arguments),
    /// Train a style water from a photo
    Train(train::Arguments),
    /// Render a style photo of a water
    StylePhoto(style_photo::Arguments),
    /// Draw the steps of the chain and the style waters for one scene
    Figure(figure::Arguments),
    /// Measure how fast a service is on this machine
    Bench(bench::Arguments),
    /// Start a service, render a small dataset with it and show the result
    Demo(demo::Arguments),
    /// Render a stored frame once more, for the service that asks for it
    #[command(hide = true)]
    Rerender(rerender::Arguments),
    /// Try a style network, for the service that was given it
    #[command(hide = true)]
    CheckStyle(check_style::Arguments),
}

impl Command {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Rerender(arguments) => rerender::run(&arguments),
            Self::CheckStyle(arguments) => check_style::run(&arguments),
            Self::Serve(arguments) => serve::run(arguments),
            Self::Worker(arguments) => worker::run(arguments),
            Self::Render(arguments) => render::run(&arguments),
            Self::Plan(arguments) => plan::run(&arguments),
            Self::Submit(arguments) => submit::run(&arguments),
            Self::Query(arguments) => query::run(&arguments),
            Self::Export(arguments) => export::run(&arguments),
            Self::Upload(arguments) => upload::run(&arguments),
            Self::Scrub(arguments) => scrub::run(&arguments),
            Self::Backup(arguments) => backup::run(&arguments),
            Self::Sheet(arguments) => sheet::run(&arguments),
            Self::Enhance(arguments) => enhance::run(&arguments),
            Self::Measure(arguments) => measure::run(&arguments),
            Self::Table1(arguments) => table1::run(&arguments),
            Self::Stability(arguments) => stability::run(&arguments),
            Self::Ladder(arguments) => ladder::run(&arguments),
            Self::Campaign(arguments) => campaign::run(&arguments),
            Self::Chart(arguments) => chart::run(&arguments),
            Self::Waters(arguments) => waters::run(&arguments),
            Self::Styles(arguments) => styles::run(&arguments),
            Self::Train(arguments) => train::run(&arguments),
            Self::StylePhoto(arguments) => style_photo::run(&arguments),
            Self::Figure(arguments) => figure::run(&arguments),
            Self::Bench(arguments) => bench::run(&arguments),
            Self::Demo(arguments) => demo::run(&arguments),
        }
    }
}

/// Where style networks and their runtime are found.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct StyleArguments {
    /// Folder with more style models: NAME.onnx and, if there is one, NAME.card.json
    #[arg(long, env = "FATHOM_STYLES", value_name = "DIR")]
    pub(crate) styles: Option<PathBuf>,
    /// The ONNX Runtime library, if it is not where scripts/get-onnxruntime.sh puts it
    #[arg(long, env = "FATHOM_ONNXRUNTIME", value_name = "FILE")]
    pub(crate) onnxruntime: Option<PathBuf>,
}
