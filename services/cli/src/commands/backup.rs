//! `fathom backup`: a copy of everything that a running service has stored.

use cli::exit::Failure;
use cli::remote::{Remote, ServerArguments};
use serde_json::Value;

/// Options of `fathom backup`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::with_patience(&arguments.server);
    let backup = remote.post_json("/v1/backups", &[], b"")?.json()?;
    let folder = backup.get("folder").and_then(Value::as_str).unwrap_or_default();
    let bytes = backup.get("bytes").and_then(Value::as_u64).unwrap_or_default();
    println!("{folder} ({} MB) on the service's machine", bytes / 1_000_000);
    println!("restore it with: fathom serve --data {folder}");
    Ok(())
}
