//! Commands of `fathom-cluster`, the program for sets, which lies beside this one.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;

use cli::exit::Failure;

use super::serve::{CLUSTER_PROGRAM, OWN_PROGRAM, own_program};

/// Whatever `fathom-cluster` takes.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _words: Vec<OsString>,
}

/// Becomes `fathom-cluster` with the words of this call, so that signals and the exit status are its own.
pub(crate) fn hand_over() -> Result<(), Failure> {
    let (own, program) = (own_program()?, program()?);
    let mut command = Command::new(&program);
    command.args(std::env::args_os().skip(1)).env(OWN_PROGRAM, own);
    let error = command.exec();
    Err(anyhow::anyhow!("cannot start {}: {error}", program.display()).into())
}

/// The file of `fathom-cluster`.
pub(super) fn program() -> Result<PathBuf, Failure> {
    let own = own_program()?;
    let program = own.with_file_name(CLUSTER_PROGRAM);
    if program.is_file() {
        return Ok(program);
    }
    Err(Failure::BadInput(format!(
        "sets are written and read by fathom-cluster, which is not beside {}; build it with \
         `cargo build --release -p cluster`",
        own.display()
    )))
}
