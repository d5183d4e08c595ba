//! The `fathom-lab` command: measures the product and draws the charts of its pages.

use std::process::ExitCode;

use clap::Parser;
use lab::experiments::{self, Request};

/// Measures Fathom and draws the charts of its pages
#[derive(Parser)]
#[command(name = "fathom-lab", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Run an experiment and write its tables, charts and pictures; without a name, list all experiments
    Experiment(Request),
}

fn main() -> ExitCode {
    let Command::Experiment(request) = Arguments::parse().command;
    cli::exit::end("fathom-lab", experiments::run(request)).into()
}
