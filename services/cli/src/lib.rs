//! What the commands `fathom` and `fathom-lab` share: exit statuses, files, progress, tables, contact sheets, the client of
//! a service, and jobs and styles as a user names them; and the commands of `fathom` themselves.

#![allow(missing_docs, reason = "read by two binaries of ours alone")]

// The commands name what they share as `fathom-lab` does.
extern crate self as cli;

mod commands;
pub mod engine;
pub mod exit;
pub mod files;
pub mod images;
pub mod job;
pub mod progress;
pub mod remote;
pub mod render;
pub mod sheet;
pub mod signals;
pub mod styles;
pub mod table;
pub mod worker;

use std::ffi::OsString;

use clap::Parser;

use exit::Failure;

/// Underwater image datasets on demand.
#[derive(Parser)]
#[command(name = "fathom", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

/// Runs a command as a shell would, from the program's name on, and returns its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    match Arguments::try_parse_from(arguments) {
        Ok(arguments) => {
            let ready = faults::check().map_err(Failure::BadInput);
            exit::end("fathom", ready.and_then(|()| arguments.command.run()))
        }
        Err(error) => {
            // Nobody is left to be told when even this cannot be printed.
            let _ = error.print();
            u8::try_from(error.exit_code()).unwrap_or(1)
        }
    }
}
