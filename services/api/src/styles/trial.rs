//! Tries an unverified network, in a process that may hang, exhaust memory or abort.

use std::ffi::OsStr;

use super::Styles;
use super::new_style::NewStyle;
use crate::http::failure::writing;
use crate::http::problem::{Problem, Slug};
use crate::processes::child::Ended;

impl Styles {
    /// Runs `fathom child check-style`; an error describes the failure.
    pub(super) async fn try_out(&self, new: &NewStyle) -> Result<(), Problem> {
        let folder = self.processes.scratch.folder().map_err(|error| writing(&error))?;
        let file = folder.path().join("model.onnx");
        let written = tokio::fs::write(&file, &new.onnx).await;
        written.map_err(|error| writing(&error))?;
        let scale = new.card.scale.unwrap_or(1.0).to_string();
        let input = new.card.picture_input();
        let size = input.size.to_string();
        let options = [
            ("--role", new.card.role.name()),
            ("--layout", input.layout.name()),
            ("--size", &size),
        ];
        let input_scale = format!("--input-scale={}", input.scale.name());
        let mut arguments = vec![
            OsStr::new("check-style"),
            OsStr::new("--model"),
            file.as_os_str(),
            OsStr::new("--name"),
            OsStr::new(&new.card.name),
            OsStr::new("--scale"),
            OsStr::new(&scale),
            OsStr::new(&input_scale),
        ];
        for (option, value) in options {
            arguments.extend([OsStr::new(option), OsStr::new(value)]);
        }
        match self
            .processes
            .children
            .run("child", &arguments, self.trial)
            .await?
        {
            Ended::Well => Ok(()),
            Ended::Refused(why) => Err(Problem::field("/model", why)),
            Ended::Lacking(what) => Err(Problem::new(Slug::RuntimeMissing, what)),
            Ended::Badly(why) => Err(Problem::field("/model", format!("it cannot be used: {why}"))),
        }
    }
}
