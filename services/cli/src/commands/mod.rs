//! One file for each command.

mod backup;
mod check_style;
mod cluster;
mod demo;
mod enhance;
mod export;
mod list;
mod measure;
mod plan;
mod query;
mod render;
mod rerender;
mod scrub;
mod serve;
mod sheet;
mod styles;
mod submit;
mod train;
mod upload;
mod waters;
mod worker;

use cli::exit::Failure;

/// The commands of `fathom`.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Start the service with its own workers
    Serve(serve::Arguments),
    /// Render frames for a service, here or on another machine
    Worker(cli::worker::Arguments),
    /// Render a job without a service
    Render(cli::render::Arguments),
    /// Show how much of a set is done
    Status(cluster::Arguments),
    /// Read a set again and compare it with its markers
    Verify(cluster::Arguments),
    /// Write the manifest of a complete set
    Seal(cluster::Arguments),
    /// Remove files of a set that belong to no shard
    Gc(cluster::Arguments),
    /// Show how a frame would be rendered: variant, error bound and cost of each stage
    Plan(plan::Arguments),
    /// Submit a job to a service
    Submit(submit::Arguments),
    /// List images by their parameters and metrics
    Query(query::Arguments),
    /// Write a dataset into a folder for training
    Export(export::Arguments),
    /// Upload scenes: pictures with their range
    Upload(upload::Arguments),
    /// Verify everything a stopped service has stored, and optionally repair it
    Scrub(scrub::Arguments),
    /// Back up everything a running service has stored
    Backup(backup::Arguments),
    /// Write a contact sheet of a dataset
    Sheet(sheet::Arguments),
    /// Enhance a picture
    Enhance(enhance::Arguments),
    /// Measure the quality of pictures
    Measure(measure::Arguments),
    /// List every name and number that a job, a question or a label may hold
    List(list::Arguments),
    /// List the optical water presets
    Waters(waters::Arguments),
    /// List the style waters
    Styles(styles::Arguments),
    /// Train a style water from a photo
    Train(train::Arguments),
    /// Render a small dataset with a temporary service and show the result
    Demo(demo::Arguments),
    /// Render a stored frame once more, for the service
    #[command(hide = true)]
    Rerender(rerender::Arguments),
    /// Try a style network, for the service
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
            Self::Status(_) | Self::Verify(_) | Self::Seal(_) | Self::Gc(_) => cluster::hand_over(),
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
            Self::List(arguments) => list::run(&arguments),
            Self::Waters(arguments) => waters::run(&arguments),
            Self::Styles(arguments) => styles::run(&arguments),
            Self::Train(arguments) => train::run(&arguments),
            Self::Demo(arguments) => demo::run(&arguments),
        }
    }
}
