//! The commands of `fathom`, and the parts that `fathom-lab` shares with them: exit statuses, files, progress,
//! tables, contact sheets, options of services, jobs and styles.

#![allow(missing_docs, reason = "read by two binaries of ours alone")]

// The commands import the shared parts by the name of the crate, like `fathom-lab`.
extern crate self as cli;

#[macro_use]
pub mod print;

pub mod classes;
pub mod colors;
mod commands;
pub mod exit;
pub mod files;
pub mod filter;
pub mod job;
pub mod known;
pub mod options;
pub mod overrides;
pub mod plot;
pub mod plural;
mod program;
pub mod progress;
pub mod sheet;
pub mod signals;
pub mod table;
mod terminal;
mod wrap;

pub use options::{engine, import, remote, render, seal, styles, worker};

use std::ffi::OsString;

use clap::FromArgMatches;

use exit::Failure;

/// Runs a command as a shell would, from the program's name on, and returns its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let matches = commands::command().try_get_matches_from(arguments);
    match matches.and_then(|matches| commands::Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => {
            if arguments.end_with_stdin {
                signals::end_with_stdin();
            }
            if arguments.wide {
                terminal::set_wide();
            }
            let ready = faults::check().map_err(Failure::BadInput);
            exit::end("fathom", ready.and_then(|()| arguments.command.run()))
        }
        Err(error) => {
            // There is no other place to report that standard error cannot be written.
            let _ = error.print();
            u8::try_from(error.exit_code()).unwrap_or(1)
        }
    }
}
