//! One file for each command.

mod backup;
mod check_style;
mod demo;
mod enhance;
mod export;
mod measure;
mod plan;
mod query;
mod render;
mod rerender;
mod scrub;
mod serve;
mod sheet;
mod style_photo;
mod styles;
mod submit;
mod train;
mod upload;
mod waters;
mod worker;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use cli::exit::Failure;
use signal_hook::consts::{SIGINT, SIGTERM};

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
    /// List the optical water presets
    Waters(waters::Arguments),
    /// List the style waters
    Styles(styles::Arguments),
    /// Train a style water from a photo
    Train(train::Arguments),
    /// Render a style photo of a water
    StylePhoto(style_photo::Arguments),
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
            Self::Waters(arguments) => waters::run(&arguments),
            Self::Styles(arguments) => styles::run(&arguments),
            Self::Train(arguments) => train::run(&arguments),
            Self::StylePhoto(arguments) => style_photo::run(&arguments),
            Self::Demo(arguments) => demo::run(&arguments),
        }
    }
}

/// Turns true when the process is asked to end.
fn stop_at_signal() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("cannot install a signal handler")?;
    }
    Ok(stop)
}
