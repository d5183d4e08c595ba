//! The `fathom` command: the service, its workers and their tools in one binary.

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(std::env::args_os()).into()
}
