//! `fathom waters add`: adds a custom water to a service.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::remote::ServerArguments;
use client::WaterView;

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
    let client = arguments.server.client();
    let water: WaterView = client.post("/v1/waters", &[], &files::read(&arguments.file)?)?;
    println!("{}", water.name);
    for warning in &water.warnings {
        eprintln!("warning: {warning}");
    }
    Ok(())
}
