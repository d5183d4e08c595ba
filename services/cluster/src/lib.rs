//! The commands of `fathom-cluster`: datasets in a store.
//!
//! A separate program, since its dependencies (Parquet, S3) would make every build of `fathom` longer. `fathom` starts it for the
//! commands below, so that users need not know it. The Python package contains them as well.

// Replaces the macros of the standard library, which panic on a closed pipe.
#[macro_use(println, eprintln)]
extern crate cli;

mod buckets;
mod commands;
mod engine;
mod failure;
mod lines;
mod reading;

use std::ffi::OsString;

use clap::{CommandFactory, Parser};

/// Datasets in a folder or a bucket, rendered by any number of machines.
#[derive(Parser)]
#[command(name = "fathom-cluster", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

/// Runs a command as a shell would, from the program's name on, and returns its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    cli::run_words(Arguments::command(), arguments, |arguments: Arguments| {
        arguments.command.run()
    })
}
