//! `fathom waters add`: adds a water of the user's own to a service.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::remote::{Remote, ServerArguments};
use cli::table::cell;

/// Options of `fathom waters add`.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  fathom waters add quay.json")]
pub(super) struct Arguments {
    /// The water as JSON: name, source, wavelengths and coefficients
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    server: ServerArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let water = remote.post("/v1/waters", &[], &files::read(&arguments.file)?)?;
    println!("{}", cell(&water["name"]));
    for warning in water["warnings"].as_array().into_iter().flatten() {
        eprintln!("warning: {}", cell(warning));
    }
    Ok(())
}
