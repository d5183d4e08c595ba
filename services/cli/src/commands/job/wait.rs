//! `fathom wait`: waits until jobs have ended.

use cli::exit::Failure;
use cli::known;

use crate::commands::job::control::Arguments;
use crate::commands::job::submit;

/// Runs the command; fails if frames of any of the jobs have no image.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let jobs = arguments.jobs.iter().map(|id| known::job(&client, id));
    let jobs = jobs.collect::<Result<Vec<_>, Failure>>()?;
    let mut outcome = Ok(());
    for job in jobs {
        let job = submit::wait(&client, &job)?;
        submit::show(&job, arguments.json);
        submit::print_frame_warnings(&client, &job)?;
        outcome = outcome.and(submit::all_rendered(&job));
    }
    outcome
}
