//! `fathom errors`: the failed frames of a job, with the reasons.

use anyhow::Context;
use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, ServerArguments, encode};
use cli::table::cell;
use serde_json::Value;

/// Options of `fathom errors`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job
    job: String,
    /// Print one JSON object per frame
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    known::job(&remote, &arguments.job)?;
    let lines = remote.get_bytes(&format!("/v1/jobs/{}/errors", encode(&arguments.job)))?;
    let failures = serde_json::Deserializer::from_slice(&lines).into_iter::<Value>();
    let failures: Result<Vec<Value>, _> = failures.collect();
    let failures = failures.context("the service's response is not JSON")?;
    if arguments.json {
        failures.iter().for_each(|failure| println!("{failure}"));
        return Ok(());
    }
    // The reason comes last and unpadded: it may be long.
    for failure in &failures {
        let given_up = failure["given_up"].as_bool().unwrap_or_default();
        println!(
            "frame {}, {} after {} attempts: {}",
            cell(&failure["frame"]),
            if given_up { "given up" } else { "still tried" },
            cell(&failure["strikes"]),
            cell(&failure["error"]),
        );
    }
    println!("{} frames", failures.len());
    Ok(())
}
