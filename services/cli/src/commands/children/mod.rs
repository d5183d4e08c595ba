//! `fathom child`: work for the service that may crash or hang, in a separate process.

mod check_style;
mod decode;
mod engine;
mod frames;
mod jobs;
mod lines;
mod live;
mod pictures;
mod rerender;
mod shards;

use cli::exit::Failure;
pub(crate) use engine::EngineArguments;

/// The tasks of child processes.
#[derive(clap::Subcommand)]
pub(crate) enum Task {
    /// Render a stored frame again
    Rerender(rerender::Arguments),
    /// Render preview frames, one after another
    Live(EngineArguments),
    /// Render pictures of requests, one after another
    Pictures(EngineArguments),
    /// Decode an upload
    Decode(decode::Arguments),
    /// Try an unverified style network
    CheckStyle(check_style::Arguments),
    /// Read a sharded dataset for the service that imports it
    Shards(shards::Arguments),
    /// Begin, change and watch the sharded datasets of a service's jobs
    Jobs(jobs::Arguments),
    /// Render frames for a supervisor
    Frames(frames::Arguments),
}

impl Task {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Rerender(arguments) => rerender::run(arguments),
            Self::Live(arguments) => live::run(arguments),
            Self::Pictures(arguments) => pictures::run(arguments),
            Self::Decode(arguments) => decode::run(arguments),
            Self::CheckStyle(arguments) => check_style::run(arguments),
            Self::Shards(arguments) => shards::run(arguments),
            Self::Jobs(arguments) => jobs::run(arguments),
            Self::Frames(arguments) => frames::run(arguments),
        }
    }
}
