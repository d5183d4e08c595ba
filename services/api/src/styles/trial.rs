//! Trying a network that nobody knows, in a process that may hang, eat memory or abort.

use std::ffi::OsStr;

use tempfile::TempDir;

use super::NewStyle;
use crate::app::App;
use crate::http::problem::{Problem, Slug};
use crate::limits;
use crate::processes::child::{Allowance, Ended};

/// Asks `fathom check-style`; an error names what the network did wrong.
pub(super) async fn run(app: &App, new: &NewStyle) -> Result<(), Problem> {
    let folder = TempDir::new().map_err(|error| crate::http::failure::writing(&error))?;
    let file = folder.path().join("model.onnx");
    tokio::fs::write(&file, &new.onnx)
        .await
        .map_err(|error| crate::http::failure::writing(&error))?;
    let arguments = [
        OsStr::new("--model"),
        file.as_os_str(),
        OsStr::new("--name"),
        OsStr::new(&new.card.name),
    ];
    let allowance = Allowance {
        time: app.style_trial,
        memory_bytes: limits::STYLE_TRIAL_MEMORY_BYTES,
    };
    match app.children.run("check-style", &arguments, allowance).await? {
        Ended::Well => Ok(()),
        Ended::Refused(why) => Err(Problem::field("/model", why)),
        Ended::Lacking(what) => Err(Problem::new(Slug::RuntimeMissing, what)),
        Ended::Badly(why) => Err(Problem::field(
            "/model",
            format!("it cannot be used; of the process that tried it: {why}"),
        )),
    }
}
