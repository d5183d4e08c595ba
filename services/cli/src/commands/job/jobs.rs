//! `fathom jobs`: lists the jobs of a service with their progress.

use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::Context;
use cli::exit::Failure;
use cli::known;
use cli::plural::{count, describe_duration};
use cli::remote::ServerArguments;
use cli::table::{DASH, table};
use client::{JobRow, JobState, UnixMs};
use serde_json::json;

/// Options of `fathom jobs`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Only jobs of this dataset
    #[arg(long)]
    dataset: Option<String>,
    /// Only jobs in this state
    #[arg(long, value_parser = JobState::ALL.map(|(_, name)| name))]
    state: Option<String>,
    /// Most jobs to print, newest first
    #[arg(long, default_value_t = 20)]
    limit: usize,
    /// Print one JSON object per job
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

const HEADER: [&str; 8] = [
    "job", "dataset", "state", "frames", "failed", "unproven", "frames/s", "left",
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let (dataset, state) = (arguments.dataset.as_deref(), arguments.state.as_deref());
    let jobs = client.jobs(dataset, state, arguments.limit)?;
    if let (true, Some(dataset)) = (jobs.is_empty(), dataset) {
        known::dataset(&client, dataset)?;
    }
    if arguments.json {
        jobs.iter().for_each(|job| println!("{}", json!(job)));
        return Ok(());
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = UnixMs(now.context("the clock is before 1970")?.as_millis() as u64);
    let ids: Vec<&str> = jobs.iter().map(|job| job.id.as_str()).collect();
    let ids = known::shorten_ids(&ids);
    let rows: Vec<Vec<String>> = jobs.iter().zip(ids).map(|(job, id)| row(job, id, now)).collect();
    println!("{}", table(&HEADER, &rows));
    println!("{}", count(jobs.len(), "job"));
    Ok(())
}

fn row(job: &JobRow, id: String, now: UnixMs) -> Vec<String> {
    let pace = Pace::new(job, now);
    let rate = pace.as_ref().map(|pace| format!("{:.2}", pace.frames_per_s));
    let remaining = pace.and_then(|pace| pace.remaining_s).map(describe_duration);
    vec![
        id,
        job.dataset.clone(),
        job.state.to_string(),
        format!("{}/{}", job.done, job.frames),
        job.failed.to_string(),
        job.unproven.to_string(),
        rate.unwrap_or_else(|| DASH.to_owned()),
        remaining.unwrap_or_else(|| DASH.to_owned()),
    ]
}

/// How fast the frames of a job end.
#[derive(Debug, PartialEq)]
struct Pace {
    frames_per_s: f64,
    /// Time to the end at that rate, while the job runs.
    remaining_s: Option<f64>,
}

impl Pace {
    /// The rate from the first frame that ended to the last, or to now. `None`: too few frames ended.
    fn new(job: &JobRow, now: UnixMs) -> Option<Self> {
        let ended = job.done + job.failed;
        let UnixMs(end) = job.finished_at.unwrap_or(now);
        let UnixMs(start) = job.started_at?;
        let seconds = (end as f64 - start as f64) / 1000.0;
        let frames_per_s = ended.checked_sub(1)? as f64 / seconds;
        let is_known = frames_per_s > 0.0 && frames_per_s.is_finite();
        is_known.then(|| Self {
            frames_per_s,
            remaining_s: (job.state == JobState::Running)
                .then(|| job.frames.saturating_sub(ended) as f64 / frames_per_s),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pace_is_that_of_the_frames_after_the_first() {
        let now = UnixMs(1_767_225_620_000);
        let mut job: JobRow = serde_json::from_value(json!({
            "id": "job_1", "dataset": "bay", "state": "running", "frames": 101, "done": 40, "failed": 1, "bytes": 0,
            "version": 3, "created_at": "2026-01-01T00:00:00.000Z", "started_at": "2026-01-01T00:00:00.000Z",
            "finished_at": null, "digest": null
        }))
        .unwrap();
        let pace = Pace::new(&job, now).unwrap();
        assert_eq!((pace.frames_per_s, pace.remaining_s), (2.0, Some(30.0)));
        job.state = JobState::Done;
        job.finished_at = Some(UnixMs(1_767_225_610_000));
        let pace = Pace::new(&job, now).unwrap();
        assert_eq!((pace.frames_per_s, pace.remaining_s), (4.0, None));
        job.done = 0;
        assert_eq!(Pace::new(&job, now), None, "one frame has no pace");
        job.started_at = None;
        assert_eq!(Pace::new(&job, now), None);
    }
}
