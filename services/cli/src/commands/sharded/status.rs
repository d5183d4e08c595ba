//! `fathom status`: how much of a sharded dataset is done.

use std::thread;
use std::time::Duration;

use anyhow::Context;
use cli::exit::Failure;
use cli::progress::Progress;
use sets::{Set, Status};

use super::failure::failure;
use super::open::open;

/// Interval between two listings with `--watch`.
const LOOK: Duration = Duration::from_secs(2);

/// Options of `fathom status`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The sharded dataset: a folder or s3://BUCKET/PREFIX
    set: String,
    /// Show a progress bar until everything is done
    #[arg(long)]
    watch: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let set = open(&arguments.set)?;
    let status = if arguments.watch {
        watch(&set)?
    } else {
        set.status().map_err(failure)?
    };
    if arguments.json {
        println!(
            "{}",
            serde_json::to_string(&status).context("the status cannot be written")?
        );
        return Ok(());
    }
    let Status {
        shards,
        done,
        frames,
        frames_done,
        failed,
        orphans,
        unfinished,
        alarms,
        ..
    } = status;
    println!("shards   {done} of {shards}");
    println!("frames   {frames_done} of {frames}, {failed} failed");
    if let (Some(rate), Some(eta_s)) = (status.rate, status.eta_s) {
        println!("rate     {rate:.2} frames/s, {eta_s:.0} s left");
    }
    println!("orphans  {orphans} files of other attempts, {unfinished} of shards that are not done");
    if alarms > 0 {
        println!("alarms   {alarms}: machines made other bytes of the same frames, see alarm/");
    }
    Ok(())
}

fn watch(set: &Set) -> Result<Status, Failure> {
    let mut progress = Progress::new("status", "frames", set.card().frames);
    loop {
        let status = set.status().map_err(failure)?;
        progress.set(status.frames_done);
        if status.done == status.shards {
            progress.finish();
            return Ok(status);
        }
        thread::sleep(LOOK);
    }
}
