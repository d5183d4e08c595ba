//! Rates of rendering without a service: slots and stages, memory, and kernels that frames share.

mod kernels;
mod slots;

use cli::exit::Failure;

use crate::report::Report;
use crate::setup::{Parameter, Setup};

/// The parameters of the speed of rendering.
pub const PARAMETERS: &[Parameter] = &[Parameter::number(
    "frames",
    "240",
    [8.0, 1e5],
    "frames of each job",
)];

/// Measures jobs on one slot and on more, and the usage of the kernel cache.
///
/// # Errors
/// A job cannot be rendered.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let frames = setup.count("frames");
    let mut tables = slots::measure(frames)?.to_vec();
    tables.extend(kernels::measure(frames));
    let about = format!(
        "{frames} frames of 768x492 for each row: a procedural structure in `jerlov-1C`, no style, the default metrics, PNG. Each slot \
         prepares the scene and its kernels once."
    );
    Ok(Report::new(about, tables))
}
