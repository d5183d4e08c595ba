//! One file for each command.

pub(crate) mod children;
pub(crate) mod dataset;
pub(crate) mod help;
pub(crate) mod job;
pub(crate) mod picture;
pub(crate) mod rendering;
pub(crate) mod reproduce;
pub(crate) mod service;
pub(crate) mod sharded;
pub(crate) mod style;

use clap::{CommandFactory, Parser};
use cli::exit::Failure;

use client::JobChange;

use dataset::{datasets, export, import, query, rm, scenes, seal, sheet, stats, upload, verify};
use help::{completions, list};
use job::{control, errors, jobs, submit, wait};
use picture::{enhance, measure};
use rendering::{bag, demo, new, plan, render, tradeoff};
use service::{backup, scrub, serve, worker};
use sharded::{gc, status};
use style::{styles, train, waters};

/// Underwater image datasets on demand.
#[derive(Parser)]
#[command(name = "fathom", version, max_term_width = 100)]
pub(crate) struct Arguments {
    /// Print tables and remarks beyond the width of the terminal, and whole ids of jobs
    #[arg(long, global = true, display_order = 900)]
    pub(crate) wide: bool,
    /// End when standard input does
    #[arg(long, global = true, hide = true)]
    pub(crate) end_with_stdin: bool,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// All commands, grouped by topic, with an example of each.
pub(crate) fn command() -> clap::Command {
    help::topics::arrange(Arguments::command())
}

/// The commands of `fathom`.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Start the service and its workers
    Serve(serve::Arguments),
    /// Render frames for a service, here or on another machine
    Worker(cli::worker::Arguments),
    /// Render a job without a service
    Render(cli::render::Arguments),
    /// Put the images of a ROS recording into water
    Bag(bag::Arguments),
    /// Show the progress of a sharded dataset
    Status(status::Arguments),
    /// Verify that a sealed dataset or a sharded dataset has not changed
    Verify(cli::seal::VerifyArguments),
    /// Import the images of a sharded dataset into a service; their bytes stay in its shards
    Import(cli::import::Arguments),
    /// Seal a dataset as a version that never changes, or a sharded dataset with its manifest
    Seal(cli::seal::SealArguments),
    /// Remove files of a sharded dataset that belong to no shard
    Gc(gc::Arguments),
    /// Write a job that starts from a site, with a comment on each field
    New(new::Arguments),
    /// Show how a frame would be rendered: variant, error bound and cost of each stage
    Plan(plan::Arguments),
    /// Chart the time of a frame against its distance to the truth, for each fidelity and effect
    Tradeoff(tradeoff::Arguments),
    /// Submit a job to a service
    Submit(submit::Arguments),
    /// List jobs with their progress
    Jobs(jobs::Arguments),
    /// Wait until jobs have ended
    Wait(control::Arguments),
    /// List the failed frames of a job with the reasons
    Errors(errors::Arguments),
    /// Try the failed frames of a job again
    Retry(control::Arguments),
    /// Let workers of any version and kind of machine finish a job; images state their origin
    FinishElsewhere(control::Arguments),
    /// Remove the images of a job and render it from the beginning
    StartAgain(control::Arguments),
    /// Pause a job; frames being rendered are finished
    Pause(control::Arguments),
    /// Resume a paused job
    Resume(control::Arguments),
    /// Cancel a job; its finished images stay
    Cancel(control::Arguments),
    /// List the datasets of a service
    Datasets(datasets::Arguments),
    /// List images by their parameters and metrics
    Query(query::Arguments),
    /// Show statistics of metrics over datasets, in groups and side by side
    Stats(stats::Arguments),
    /// Write a dataset into a folder for training
    Export(export::Arguments),
    /// List uploaded scenes
    Scenes(scenes::Arguments),
    /// Delete jobs and datasets with their images, and scenes that no job uses
    Rm(rm::Arguments),
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
    /// List every name and number that a job, a query or a label may hold
    List(list::Arguments),
    /// List the optical waters, or add one to a service
    Waters(waters::Arguments),
    /// List the style waters, or add one to a service
    Styles(styles::Arguments),
    /// Train a style water from a photo
    Train(train::Arguments),
    /// Render a small dataset with a temporary service and show the result
    Demo(demo::Arguments),
    /// Write a page with the figures and the table of the published method
    Reproduce(reproduce::Arguments),
    /// Print the completions of a shell
    Completions(completions::Arguments),
    /// Write manual pages
    Man(completions::ManArguments),
    /// Do work for the service that may crash or hang
    #[command(hide = true, subcommand)]
    Child(children::Task),
}

impl Command {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Child(task) => task.run(),
            Self::Serve(arguments) => serve::run(arguments),
            Self::Worker(arguments) => worker::run(arguments),
            Self::Render(arguments) => render::run(&arguments),
            Self::Bag(arguments) => bag::run(&arguments),
            Self::Status(arguments) => status::run(&arguments),
            Self::Gc(arguments) => gc::run(&arguments),
            Self::Seal(arguments) => seal::run(&arguments),
            Self::Verify(arguments) => verify::run(&arguments),
            Self::Import(arguments) => import::run(&arguments),
            Self::New(arguments) => new::run(&arguments),
            Self::Plan(arguments) => plan::run(&arguments),
            Self::Tradeoff(arguments) => tradeoff::run(&arguments),
            Self::Submit(arguments) => submit::run(&arguments),
            Self::Jobs(arguments) => jobs::run(&arguments),
            Self::Wait(arguments) => wait::run(&arguments),
            Self::Errors(arguments) => errors::run(&arguments),
            Self::Retry(arguments) => control::run(&arguments, JobChange::RetryFailed),
            Self::FinishElsewhere(arguments) => control::run(&arguments, JobChange::FinishElsewhere),
            Self::StartAgain(arguments) => control::run(&arguments, JobChange::StartAgain),
            Self::Pause(arguments) => control::run(&arguments, JobChange::Pause),
            Self::Resume(arguments) => control::run(&arguments, JobChange::Resume),
            Self::Cancel(arguments) => control::run(&arguments, JobChange::Cancel),
            Self::Datasets(arguments) => datasets::run(&arguments),
            Self::Scenes(arguments) => scenes::run(&arguments),
            Self::Rm(arguments) => rm::run(&arguments),
            Self::Completions(arguments) => completions::run(&arguments, command()),
            Self::Man(arguments) => completions::write_pages(&arguments, command()),
            Self::Query(arguments) => query::run(&arguments),
            Self::Stats(arguments) => stats::run(&arguments),
            Self::Export(arguments) => export::run(arguments),
            Self::Upload(arguments) => upload::run(arguments),
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
            Self::Reproduce(arguments) => reproduce::run(&arguments),
        }
    }
}
