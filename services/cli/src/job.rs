//! A job in a file named by the user.

use std::collections::BTreeMap;
use std::path::Path;

use quality::MetricId;
use spec::{Draft, Invalid, Job, METRIC_NETWORK, Uploads};
use style::Library;

use crate::exit::Failure;
use crate::files;
use crate::overrides::Override;
use crate::plural::count;

/// Reads a job to render here, whose scene may be local files. Uploaded scenes are refused: only a service has them.
pub fn read(path: &Path, library: &Library) -> Result<Job, Failure> {
    check(path, &files::read(path)?, library)
}

/// Checks the text of a job with some fields replaced. All replacements that cannot be made are reported together.
pub fn read_with(
    path: &Path,
    text: &[u8],
    overrides: &[Override],
    library: &Library,
) -> Result<Job, Failure> {
    if overrides.is_empty() {
        return check(path, text, library);
    }
    let mut description = spec::read_json(text).map_err(|invalid| refused(path, &invalid))?;
    let applied = overrides.iter().map(|replaced| replaced.apply(&mut description));
    let wrong: Vec<String> = applied.filter_map(Result::err).collect();
    if !wrong.is_empty() {
        return Err(Failure::BadInput(wrong.join("\n")));
    }
    check(path, description.to_string().as_bytes(), library)
}

fn check(path: &Path, text: &[u8], library: &Library) -> Result<Job, Failure> {
    let vocabulary = renderer::vocabulary(library, true);
    Draft::read(text, &vocabulary)
        .and_then(|draft| draft.check(&Uploads::Known(BTreeMap::new())))
        .map_err(|invalid| refused(path, &invalid))
}

/// The metrics that frames of a job can have: those of this program, and networks that the job names.
#[must_use]
pub fn metrics(job: &Job) -> Vec<String> {
    let networks = job.metric_networks().into_iter();
    let networks = networks.map(|name| format!("{METRIC_NETWORK}{name}"));
    let registered = MetricId::all().map(|metric| metric.to_string());
    registered.chain(networks).collect()
}

/// The errors of a job description, one per line.
#[must_use]
pub fn refused(path: &Path, invalid: &Invalid) -> Failure {
    let mut message = format!("{}: {}", path.display(), count(invalid.0.len(), "error"));
    for error in &invalid.0 {
        message.push_str(&format!("\n  {} {}", error.pointer, error.message));
        if let Some(near) = &error.did_you_mean {
            message.push_str(&format!(" (did you mean `{near}`?)"));
        }
    }
    Failure::BadInput(message)
}
