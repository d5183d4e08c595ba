//! The commands of the `fathom` binary.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs a command of `fathom` and returns its exit status.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let program = OsString::from("fathom");
    py.detach(|| cli::run(std::iter::once(program).chain(arguments)))
}
