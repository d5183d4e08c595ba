//! Lines of JSON for the service that started this process.

use std::io::{Write, stdout};

use anyhow::Context;
use cli::exit::Failure;
use serde::Serialize;

/// A message as a line.
pub(crate) fn line(message: &impl Serialize) -> Result<Vec<u8>, Failure> {
    let mut line = serde_json::to_vec(message).context("a message cannot be written as JSON")?;
    line.push(b'\n');
    Ok(line)
}

/// Writes a line to standard output.
pub(crate) fn write(line: &[u8]) -> Result<(), Failure> {
    let mut out = stdout().lock();
    let written = out.write_all(line).and_then(|()| out.flush());
    Ok(written.context("cannot write to standard output")?)
}
