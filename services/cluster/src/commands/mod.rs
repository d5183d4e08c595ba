//! One file for each command.

mod dispatch;
mod export;
mod frames;
mod gc;
mod import;
mod jobs;
mod open;
mod render;
mod seal;
mod shards;
mod status;
mod tally;
mod verify;
mod worker;

use cli::exit::Failure;

use crate::buckets;
use crate::failure::failure;

/// What `fathom-cluster` can do.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Render a job into a set, or the part of it that is missing
    Render(cli::render::Arguments),
    /// Render shards from a broker
    Worker(cli::worker::Arguments),
    /// Show how much of a set is done
    Status(status::Arguments),
    /// Read a set again and compare it with its markers
    Verify(cli::seal::VerifyArguments),
    /// Show the images of a set in a service, whose bytes stay where they are
    Import(cli::import::Arguments),
    /// Start the service, also over a data folder with images of a set in a bucket
    Serve(cli::serve::Arguments),
    /// Verify everything a stopped service has stored, also images of a set in a bucket
    Scrub(cli::scrub::Arguments),
    /// Write the manifest of a set that is complete
    Seal(cli::seal::SealArguments),
    /// Remove files that belong to no shard
    Gc(gc::Arguments),
    /// Read a set for the service that imports it
    #[command(hide = true)]
    Shards(shards::Arguments),
    /// Export a dataset, also to formats that hold Parquet
    Export(cli::export::Arguments),
    /// Begin, change and watch the sets of a service's jobs
    #[command(hide = true)]
    Jobs(jobs::Arguments),
    /// Render frames for a supervisor
    #[command(hide = true)]
    Frames(frames::Arguments),
}

impl Command {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Render(arguments) => render::run(&arguments),
            Self::Worker(arguments) => worker::run(&arguments),
            Self::Status(arguments) => status::run(&arguments),
            Self::Verify(arguments) => verify::run(&arguments),
            Self::Import(arguments) => import::run(&arguments),
            Self::Serve(arguments) => cli::serve::run(arguments, Some(buckets::reader())),
            Self::Scrub(arguments) => cli::scrub::run(&arguments, Some(buckets::reader())),
            Self::Seal(arguments) => seal::run(&arguments),
            Self::Gc(arguments) => gc::run(&arguments),
            Self::Shards(arguments) => shards::run(&arguments),
            Self::Export(arguments) => cli::export::run(&arguments, Some(export::write)),
            Self::Jobs(arguments) => jobs::run(&arguments),
            Self::Frames(arguments) => frames::run(&arguments),
        }
    }
}
