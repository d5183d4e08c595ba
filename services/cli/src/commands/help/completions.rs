//! `fathom completions` and `fathom man`: files for shells and for `man`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap_complete::Shell;
use cli::exit::Failure;

/// Options of `fathom completions`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The shell
    shell: Shell,
}

/// Options of `fathom man`.
#[derive(clap::Args)]
pub(crate) struct ManArguments {
    /// Folder for the pages, one for each command
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Prints the script of a shell for these commands.
pub(crate) fn run(arguments: &Arguments, mut command: clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "fathom", &mut script);
    match std::io::stdout().write_all(&script) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(anyhow::Error::from(error)
            .context("cannot print the script")
            .into()),
        _ => Ok(()),
    }
}

/// Writes the pages of these commands.
pub(crate) fn write_pages(arguments: &ManArguments, command: clap::Command) -> Result<(), Failure> {
    let folder = &arguments.folder;
    let written = std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(command, folder));
    written.with_context(|| format!("cannot write to {}", folder.display()))?;
    println!("{}", folder.join("fathom.1").display());
    Ok(())
}
