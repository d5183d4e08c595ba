//! `fathom backup`: a copy of everything that a running service has stored.

use cli::exit::Failure;
use cli::plural::describe_bytes;
use cli::remote::ServerArguments;
use client::BackupView;

/// Options of `fathom backup`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let BackupView { folder, bytes } = arguments.server.patient_client().back_up()?;
    println!(
        "{folder} ({}) on the service's machine",
        describe_bytes(bytes as f64)
    );
    println!("restore it with: fathom serve --data {folder}");
    Ok(())
}
