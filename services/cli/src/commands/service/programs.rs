//! The programs that a service starts.

use std::path::PathBuf;

use anyhow::Context;
use cli::exit::Failure;

/// Names the program of these commands if another program embeds them.
pub(crate) const OWN_PROGRAM: &str = "FATHOM_PROGRAM";

/// The program that can also read sets in buckets.
pub(crate) const CLUSTER_PROGRAM: &str = "fathom-cluster";

/// The program of these commands: this one, unless an embedding program names it.
pub(crate) fn own_program() -> Result<PathBuf, Failure> {
    let named = std::env::var_os(OWN_PROGRAM).map(PathBuf::from);
    let own = named.map_or_else(std::env::current_exe, Ok);
    let own = own.context("cannot find the file of this program")?;
    // `fathom-cluster` has only some of these commands; `fathom`, next to it, has all of them.
    if own.file_name().is_some_and(|name| name == CLUSTER_PROGRAM) {
        return Ok(own.with_file_name("fathom"));
    }
    Ok(own)
}
