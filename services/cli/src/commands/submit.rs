//! `fathom submit`: submits a job to a service and optionally waits for it.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::remote::{Remote, ServerArguments, encode, with_query};
use serde_json::Value;

/// Options of `fathom submit`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description with laws, as JSON
    spec: PathBuf,
    /// Wait until the job is finished
    #[arg(long)]
    wait: bool,
    /// Key of the submission: submitting again with the same key returns the same job
    #[arg(long, value_name = "KEY")]
    idempotency_key: Option<String>,
    /// Render it although its dataset has every image of it already
    #[arg(long)]
    again: bool,
    /// Print the job as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let spec = files::read(&arguments.spec)?;
    let job = submit(
        &remote,
        &spec,
        arguments.idempotency_key.as_deref(),
        arguments.again,
    )?;
    if !arguments.wait {
        show(&job, arguments.json);
        return Ok(());
    }
    let job = wait(&remote, &job)?;
    show(&job, arguments.json);
    all_rendered(&job)
}

/// Prints a job on a line, and its digest once it has one.
pub(crate) fn show(job: &Value, as_json: bool) {
    if as_json {
        println!("{job}");
        return;
    }
    println!(
        "job {} · dataset {} · {} · {} of {} frames",
        text(job, "id"),
        text(job, "dataset"),
        text(job, "state"),
        number(job, "done"),
        number(job, "frames")
    );
    if let Some(digest) = job["digest"].as_str() {
        println!("digest {digest}");
    }
}

/// Fails if a job has ended without all of its frames.
pub(crate) fn all_rendered(job: &Value) -> Result<(), Failure> {
    let (id, done, frames) = (text(job, "id"), number(job, "done"), number(job, "frames"));
    match text(job, "state") {
        "done_with_failures" => Err(Failure::SomeFrames {
            failed: number(job, "failed"),
            frames,
            hint: format!("; see `fathom errors {id}`"),
        }),
        "cancelled" => {
            Err(anyhow::anyhow!("job {id} was cancelled with {done} of {frames} frames done").into())
        }
        _ => Ok(()),
    }
}

/// Submits a job description and returns the job as the service shows it; with `again` also one whose images its dataset has.
pub(crate) fn submit(remote: &Remote, spec: &[u8], key: Option<&str>, again: bool) -> Result<Value, Failure> {
    let headers: Vec<(&str, &str)> = key.map(|key| ("idempotency-key", key)).into_iter().collect();
    let path = with_query("/v1/jobs", &[("again", again.then_some("true"))]);
    let job = remote.post(&path, &headers, spec)?;
    for warning in job["warnings"].as_array().into_iter().flatten() {
        eprintln!("warning: {}", warning.as_str().unwrap_or_default());
    }
    Ok(job)
}

/// Waits with long polls until a job is finished.
pub(crate) fn wait(remote: &Remote, job: &Value) -> Result<Value, Failure> {
    let id = text(job, "id").to_owned();
    let mut progress = Progress::new(text(job, "dataset"), "frames", number(job, "frames"));
    // Below the version of every job: the first response comes at once.
    let (mut seen, mut was_paused) = (0, false);
    loop {
        let job = remote.get(&format!("/v1/jobs/{}?wait=30&since={seen}", encode(&id)))?;
        seen = number(&job, "version");
        progress.set(number(&job, "done") + number(&job, "failed"));
        if text(&job, "state") == "paused" && !was_paused {
            eprintln!("job {id} is paused; it goes on with `fathom resume {id}`");
        }
        was_paused = text(&job, "state") == "paused";
        if matches!(text(&job, "state"), "done" | "done_with_failures" | "cancelled") {
            progress.finish();
            return Ok(job);
        }
    }
}

fn text<'a>(job: &'a Value, name: &str) -> &'a str {
    job[name].as_str().unwrap_or_default()
}

fn number(job: &Value, name: &str) -> u64 {
    job[name].as_u64().unwrap_or_default()
}
