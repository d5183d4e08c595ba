//! `fathom-lab bench`: how fast rendering and the service are on this machine.

mod render;
mod service;
mod style;

use std::path::PathBuf;

use cli::exit::Failure;
use cli::styles::StyleArguments;

/// Options of `fathom-lab bench`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Submissions, claims, commits, pages and counts over a catalogue of many rows
    Service(ServiceArguments),
    /// Frames and stages on one slot and on all, memory, kernels: writes speed.md
    Render(RenderArguments),
    /// Speed of the style tiers and of a usual network, and distances between tiers and between waters
    Style(StyleBench),
}

/// Options of `fathom-lab bench render`.
#[derive(clap::Args)]
pub(crate) struct RenderArguments {
    /// Frames of each job
    #[arg(long, default_value_t = 240, value_parser = clap::value_parser!(u32).range(8..=100_000))]
    frames: u32,
    /// Folder for speed.md
    #[arg(long, value_name = "DIR", default_value = "bench")]
    out: PathBuf,
}

/// Options of `fathom-lab bench service`.
#[derive(clap::Args)]
pub(crate) struct ServiceArguments {
    /// Images in the catalogue; as many frames wait
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1000..=50_000_000))]
    rows: u64,
    /// Folder to measure on, which must not exist; it is removed afterwards [default: in the system's temporary folder]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

/// Options of `fathom-lab bench style`.
#[derive(clap::Args)]
pub(crate) struct StyleBench {
    #[command(flatten)]
    style: StyleArguments,
    /// Runs of each; the fastest counts
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Folder for style-bench.md
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.what {
        What::Service(arguments) => service::run(arguments),
        What::Style(arguments) => style::run(arguments),
        What::Render(arguments) => render::run(arguments),
    }
}
