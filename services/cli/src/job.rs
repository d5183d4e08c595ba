//! A job as a file that the user named.

use std::path::Path;

use spec::{Invalid, Job};
use style::Library;

use crate::exit::Failure;
use crate::files;

/// Reads a job that may name files of this machine.
pub fn read(path: &Path, library: &Library) -> Result<Job, Failure> {
    let text = files::read(path)?;
    Job::parse(&text, &renderer::vocabulary(library, true)).map_err(|invalid| refused(path, &invalid))
}

/// Every error of a job description, one per line.
#[must_use]
pub fn refused(path: &Path, invalid: &Invalid) -> Failure {
    let mut message = format!("{}: {} errors", path.display(), invalid.0.len());
    for error in &invalid.0 {
        message.push_str(&format!("\n  {} {}", error.pointer, error.message));
        if let Some(near) = &error.did_you_mean {
            message.push_str(&format!(" (did you mean `{near}`?)"));
        }
    }
    Failure::BadInput(message)
}
