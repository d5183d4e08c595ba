//! Commands of `fathom-cluster`, the program for sets, which is next to this one.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use cli::exit::Failure;

use super::programs::{CLUSTER_PROGRAM, OWN_PROGRAM, own_program};

/// Arguments of `fathom-cluster`.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _words: Vec<OsString>,
}

/// The arguments of this call, which differ from those of the process if another program such as Python runs the command.
static WORDS: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// Stores the arguments of this call, from the program's name on.
pub(crate) fn note(words: &[OsString]) {
    *WORDS.lock().unwrap_or_else(PoisonError::into_inner) = words.to_vec();
}

/// Replaces this process by `fathom-cluster` with the same arguments, so that signals and the exit status are passed through.
pub(crate) fn hand_over() -> Result<(), Failure> {
    let (own, program) = (own_program()?, program()?);
    let mut command = Command::new(&program);
    let words = WORDS.lock().unwrap_or_else(PoisonError::into_inner).clone();
    command.args(words.into_iter().skip(1)).env(OWN_PROGRAM, own);
    let error = command.exec();
    Err(anyhow::anyhow!("cannot start {}: {error}", program.display()).into())
}

/// The file of `fathom-cluster`: next to this program, otherwise on the PATH (for a program that embeds these commands).
pub fn program() -> Result<PathBuf, Failure> {
    let own = own_program()?;
    let path = std::env::var_os("PATH").unwrap_or_default();
    let on_path = std::env::split_paths(&path).map(|folder| folder.join(CLUSTER_PROGRAM));
    let mut programs = std::iter::once(own.with_file_name(CLUSTER_PROGRAM)).chain(on_path);
    let program = programs.find(|program| program.is_file());
    program.ok_or_else(|| {
        Failure::BadInput(format!(
            "sets and Parquet files need fathom-cluster, which is neither next to {} nor on the PATH; \
             build it with `cargo build --release -p cluster`",
            own.display()
        ))
    })
}
