//! `fathom import`: the images of a sharded dataset in a running service, which imports it itself, or in a data folder.

use std::time::Duration;

use anyhow::Context;
use cli::exit::Failure;
use cli::import::Arguments;
use cli::known;
use cli::progress::Progress;
use client::{Client, JobRow, SetView};
use serde_json::json;

use crate::commands::job::submit::{all_rendered, show};
use crate::commands::sharded;

/// Shortest time between two requests for the state of a set.
const PAUSE: Duration = Duration::from_millis(200);
/// Seconds of a long poll; short, since an error of the set does not change its job.
const WAIT_S: u64 = 5;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(client) = arguments.server.client() else {
        return sharded::import::run(arguments);
    };
    let set = client.import_set(&url(&arguments.set)?)?;
    let set = match arguments.wait {
        true => wait(&client, &set)?,
        false => set,
    };
    let job = known::job(&client, &set.job)?;
    if arguments.json {
        println!("{}", json!(set));
    } else {
        show(&job, false);
    }
    match arguments.wait {
        true => all_rendered(&job),
        false => Ok(()),
    }
}

/// The URL of a set; a folder is named by its absolute path, which is valid for a service on this machine.
fn url(set: &str) -> Result<String, Failure> {
    if set.contains("://") {
        return Ok(set.to_owned());
    }
    let path = std::path::absolute(set).context("no working folder")?;
    let text = path.to_str().map(str::to_owned);
    text.ok_or_else(|| Failure::input(format!("{} is not UTF-8", path.display())))
}

/// Waits until the service no longer looks for shards of a set.
fn wait(client: &Client, set: &SetView) -> Result<SetView, Failure> {
    let mut progress = Progress::new("import", "frames", set.frames);
    let (mut version, mut reported) = (0, None);
    loop {
        // The response for a job that has ended is immediate, though the service may still look at its set.
        std::thread::sleep(PAUSE);
        let JobRow {
            version: current,
            done,
            failed,
            ..
        } = client.await_job(&set.job, version, WAIT_S)?;
        version = current;
        progress.set(done + failed);
        let set = client.set(&set.job)?;
        if !set.followed {
            if let Some(error) = set.error {
                return Err(anyhow::Error::msg(error).into());
            }
            if set.looked_at.is_some() {
                progress.finish();
                return Ok(set);
            }
        } else if set.error.is_some() && set.error != reported {
            reported = set.error;
            let error = reported.as_deref().unwrap_or_default();
            eprintln!("{error}; the service tries again");
        }
    }
}
