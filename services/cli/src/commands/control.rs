//! `fathom cancel`, `pause`, `resume` and `retry`: change what jobs do.

use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, ServerArguments, encode};

use super::submit;

/// Options of these commands and of `fathom wait`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Ids of the jobs
    #[arg(required = true, value_name = "JOB")]
    pub(super) jobs: Vec<String>,
    /// Print one JSON object per job
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) server: ServerArguments,
}

/// What to do with a job.
pub(crate) enum Change {
    Cancel,
    Pause,
    Resume,
    Retry,
}

/// Changes the jobs one after the other, as far as the first that cannot be changed.
pub(crate) fn run(arguments: &Arguments, change: &Change) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let route = match change {
        Change::Cancel => "cancel",
        Change::Pause => "pause",
        Change::Resume => "resume",
        Change::Retry => "retry-failed",
    };
    for id in &arguments.jobs {
        known::job(&remote, id)?;
        let job = remote.post(&format!("/v1/jobs/{}/{route}", encode(id)), &[], b"")?;
        submit::show(&job, arguments.json);
    }
    Ok(())
}
