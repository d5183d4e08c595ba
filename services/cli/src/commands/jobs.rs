//! `fathom jobs`: lists the jobs of a service with their progress.

use catalogue::JobState;
use chrono::{DateTime, Utc};
use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, ServerArguments};
use cli::table::{cell, table};
use serde_json::Value;

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

const HEADER: [&str; 7] = ["job", "dataset", "state", "frames", "failed", "frames/s", "left"];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let parameters = [
        ("dataset", arguments.dataset.as_deref()),
        ("state", arguments.state.as_deref()),
    ];
    let jobs = remote.rows("/v1/jobs", &parameters, arguments.limit)?;
    if jobs.is_empty()
        && let Some(dataset) = &arguments.dataset
    {
        known::dataset(&remote, dataset)?;
    }
    if arguments.json {
        jobs.iter().for_each(|job| println!("{job}"));
        return Ok(());
    }
    let now = DateTime::from(std::time::SystemTime::now());
    let rows: Vec<Vec<String>> = jobs.iter().map(|job| row(job, now)).collect();
    println!("{}", table(&HEADER, &rows));
    println!("{} jobs", jobs.len());
    Ok(())
}

fn row(job: &Value, now: DateTime<Utc>) -> Vec<String> {
    let number = |name: &str| job[name].as_u64().unwrap_or_default();
    let pace = Pace::new(job, now);
    let dash = || "–".to_owned();
    vec![
        cell(&job["id"]),
        cell(&job["dataset"]),
        cell(&job["state"]),
        format!("{}/{}", number("done"), number("frames")),
        number("failed").to_string(),
        pace.as_ref()
            .map_or_else(dash, |pace| format!("{:.2}", pace.frames_per_s)),
        pace.and_then(|pace| pace.left_s).map_or_else(dash, duration),
    ]
}

/// How fast the frames of a job end.
#[derive(Debug, PartialEq)]
struct Pace {
    frames_per_s: f64,
    /// Time to the end at that rate, while the job runs.
    left_s: Option<f64>,
}

impl Pace {
    /// From the first frame that ended, which stands for the start, to the last or to now. None: too few frames ended.
    fn new(job: &Value, now: DateTime<Utc>) -> Option<Self> {
        let number = |name: &str| job[name].as_u64().unwrap_or_default();
        let time = |name: &str| DateTime::parse_from_rfc3339(job[name].as_str()?).ok();
        let ended = number("done") + number("failed");
        let until = time("finished_at").map_or(now, |time| time.to_utc());
        let seconds = (until - time("started_at")?.to_utc()).as_seconds_f64();
        let frames_per_s = ended.checked_sub(1)? as f64 / seconds;
        let is_meant = frames_per_s > 0.0 && frames_per_s.is_finite();
        is_meant.then(|| Self {
            frames_per_s,
            left_s: (job["state"] == "running")
                .then(|| number("frames").saturating_sub(ended) as f64 / frames_per_s),
        })
    }
}

/// Such as `3 min 20 s`.
fn duration(seconds: f64) -> String {
    let seconds = seconds.ceil() as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s"),
        (hours, minutes, _) => format!("{hours} h {minutes} min"),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_pace_is_that_of_the_frames_after_the_first() {
        let now = DateTime::parse_from_rfc3339("2026-01-01T00:00:20Z")
            .unwrap()
            .to_utc();
        let mut job = json!({"state": "running", "frames": 101, "done": 40, "failed": 1,
            "started_at": "2026-01-01T00:00:00.000Z", "finished_at": null});
        let pace = Pace::new(&job, now).unwrap();
        assert_eq!((pace.frames_per_s, pace.left_s), (2.0, Some(30.0)));
        job["state"] = json!("done");
        job["finished_at"] = json!("2026-01-01T00:00:10.000Z");
        let pace = Pace::new(&job, now).unwrap();
        assert_eq!((pace.frames_per_s, pace.left_s), (4.0, None));
        job["done"] = json!(0);
        assert_eq!(Pace::new(&job, now), None, "one frame has no pace");
        job["started_at"] = Value::Null;
        assert_eq!(Pace::new(&job, now), None);
    }

    #[test]
    fn durations_have_two_units_at_most() {
        assert_eq!(
            [0.2, 61.0, 7260.0].map(duration),
            ["1 s", "1 min 1 s", "2 h 1 min"]
        );
    }
}
