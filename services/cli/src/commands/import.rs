//! `fathom import`: the images of a set in a service. A running one imports it itself; for a data folder this command becomes
//! `fathom-cluster`.

use std::time::Duration;

use anyhow::Context;
use cli::exit::Failure;
use cli::import::Arguments;
use cli::progress::Progress;
use cli::remote::{Remote, encode};
use serde_json::{Value, json};

use super::cluster;
use super::submit::{all_rendered, show};

/// Between two questions to the service, at least.
const PAUSE: Duration = Duration::from_millis(200);

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(remote) = arguments.server.remote() else {
        return cluster::hand_over();
    };
    let body = json!({"url": url(&arguments.set)?}).to_string();
    let set = remote.post("/v1/sets", &[], body.as_bytes())?;
    let job = set["job"].as_str().unwrap_or_default();
    let (set, job) = if arguments.wait {
        wait(&remote, &set, job)?
    } else {
        let row = remote.get(&format!("/v1/jobs/{}", encode(job)))?;
        (set, row)
    };
    if arguments.json {
        println!("{set}");
    } else {
        show(&job, false);
    }
    if arguments.wait {
        all_rendered(&job)
    } else {
        Ok(())
    }
}

/// A folder as the service finds it, too, on this machine at least.
fn url(set: &str) -> Result<String, Failure> {
    if set.contains("://") {
        return Ok(set.to_owned());
    }
    let path = std::path::absolute(set).context("no working folder")?;
    let text = path.to_str().map(str::to_owned);
    text.ok_or_else(|| Failure::input(format!("{} is not UTF-8", path.display())))
}

/// Waits until the service looks no further; returns the set and its job.
fn wait(remote: &Remote, set: &Value, job: &str) -> Result<(Value, Value), Failure> {
    let mut progress = Progress::new("import", "frames", set["frames"].as_u64().unwrap_or_default());
    let (mut seen, mut said) = (0, None);
    loop {
        // A job that has ended is shown at once, though the service may still look at its set.
        std::thread::sleep(PAUSE);
        // An error of the set is no change of the job: look at it from time to time.
        let row = remote.get(&format!("/v1/jobs/{}?wait=5&since={seen}", encode(job)))?;
        seen = row["version"].as_u64().unwrap_or_default();
        let count = |name: &str| row[name].as_u64().unwrap_or_default();
        progress.set(count("done") + count("failed"));
        let set = remote.get(&format!("/v1/sets/{}", encode(job)))?;
        let error = set["error"].as_str().map(str::to_owned);
        let goes_on = set["followed"] == json!(true);
        match error {
            Some(error) if !goes_on => return Err(Failure::Other(anyhow::Error::msg(error))),
            Some(error) if said.as_ref() != Some(&error) => {
                eprintln!("{error}; the service tries again");
                said = Some(error);
            }
            _ => {}
        }
        if !goes_on && !set["looked_at"].is_null() {
            progress.finish();
            // The last look may have changed it.
            let row = remote.get(&format!("/v1/jobs/{}", encode(job)))?;
            return Ok((set, row));
        }
    }
}
