//! `fathom child decode`: decodes an upload for the service.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;

/// Options of `fathom child decode`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder with `request.json` and the files; `reply.json` is written there
    #[arg(long)]
    folder: PathBuf,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let decoded = api::decode_folder(&arguments.folder).context("the folder is not one of the service");
    Ok(decoded?)
}
