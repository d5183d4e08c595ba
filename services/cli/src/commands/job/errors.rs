//! `fathom errors`: the failed frames of a job, with the reasons.

use cli::exit::Failure;
use cli::known;
use cli::plural::count;
use cli::remote::ServerArguments;
use client::FailureRow;
use serde_json::json;

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
    let client = arguments.server.client();
    let job = known::job(&client, &arguments.job)?;
    let failures = client.failed_frames(&job.id)?;
    if arguments.json {
        failures.iter().for_each(|failure| println!("{}", json!(failure)));
        return Ok(());
    }
    // The reason comes last and unpadded: it may be long.
    for FailureRow {
        frame,
        strikes,
        quarantined,
        error,
    } in &failures
    {
        let state = if *quarantined { "given up" } else { "still tried" };
        println!(
            "frame {frame}, {state} after {}: {error}",
            count(strikes, "attempt")
        );
    }
    println!("{}", count(failures.len(), "frame"));
    Ok(())
}
