//! `fathom cancel`, `pause`, `resume`, `retry`, `finish-elsewhere` and `start-again`: change jobs.

use cli::exit::Failure;
use cli::known;
use cli::remote::ServerArguments;
use client::JobChange;

use crate::commands::job::submit;

/// Options of these commands and of `fathom wait`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Ids of the jobs, or their beginnings
    #[arg(required = true, value_name = "JOB")]
    pub(crate) jobs: Vec<String>,
    /// Print one JSON object per job
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) server: ServerArguments,
}

/// Changes the jobs one after the other; stops at the first that cannot be changed.
pub(crate) fn run(arguments: &Arguments, change: JobChange) -> Result<(), Failure> {
    let client = arguments.server.client();
    for id in &arguments.jobs {
        let job = known::job(&client, id)?;
        submit::show(&client.change_job(&job.id, change)?, arguments.json);
    }
    Ok(())
}
