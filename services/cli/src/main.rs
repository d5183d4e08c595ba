//! The `fathom` command: the service, its workers and their tools in one binary.

mod commands;

use std::process::ExitCode;

use clap::Parser;
use cli::exit::{self, Failure};

/// Underwater image datasets on demand.
#[derive(Parser)]
#[command(name = "fathom", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let ready = faults::check().map_err(Failure::BadInput);
    exit::end("fathom", ready.and_then(|()| arguments.command.run()))
}
