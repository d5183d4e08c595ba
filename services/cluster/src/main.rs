//! The `fathom-cluster` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    cluster::run(std::env::args_os()).into()
}
