//! `fathom backup`: a copy of everything that a running service has stored.

use cli::exit::Failure;
use cli::remote::{Remote, ServerArguments};

/// Options of `fathom backup`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::with_patience(&arguments.server);
    let backup = remote.post("/v1/backups", &[], b"")?;
    let folder = backup["folder"].as_str().unwrap_or_default();
    let bytes = backup["bytes"].as_u64().unwrap_or_default();
    println!("{folder} ({} MB) on the service's machine", bytes / 1_000_000);
    println!("restore it with: fathom serve --data {folder}");
    Ok(())
}
