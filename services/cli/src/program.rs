//! The file of this program, which starts itself as a child.

use std::path::PathBuf;

use crate::exit::Failure;
use anyhow::Context;

/// Names the program of these commands if another program embeds them.
const OWN_PROGRAM: &str = "FATHOM_PROGRAM";

/// The program of these commands: this one, unless an embedding program names it.
pub(crate) fn own_program() -> Result<PathBuf, Failure> {
    let named = std::env::var_os(OWN_PROGRAM).map(PathBuf::from);
    let own = named.map_or_else(std::env::current_exe, Ok);
    Ok(own.context("cannot find the file of this program")?)
}
