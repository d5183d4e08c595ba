//! The `fathom` command: one binary for the service, its workers and everything a person does with them.

mod commands;
mod exit;
mod files;
mod machine;
mod progress;
mod remote;
mod sheet;
mod table;

use std::process::ExitCode;

use clap::Parser;
use exit::Failure;

/// Underwater image datasets on demand.
#[derive(Parser)]
#[command(name = "fathom", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let run = || {
        faults::check()
            .map_err(Failure::BadInput)
            .and_then(|()| arguments.command.run())
    };
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("fathom: {failure}");
            failure.code()
        }
    }
}
