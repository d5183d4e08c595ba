//! The `fathom-cluster` command: what `fathom` does with datasets in a store.
//!
//! A program of its own, since what it needs (Parquet, S3) would make every build of `fathom` longer. `fathom` starts it
//! for the commands below, so that a user need not know it.

mod buckets;
mod commands;
mod engine;
mod failure;
mod lines;
mod reading;

use std::process::ExitCode;

use clap::Parser;
use cli::exit::{self, Failure};

/// Datasets in a folder or a bucket, rendered by any number of machines.
#[derive(Parser)]
#[command(name = "fathom-cluster", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let ready = faults::check().map_err(Failure::BadInput);
    exit::end("fathom", ready.and_then(|()| arguments.command.run())).into()
}
