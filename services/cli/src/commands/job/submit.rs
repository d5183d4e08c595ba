//! `fathom submit`: submits a job to a service and optionally waits for it.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::known::shorten_id;
use cli::plural::{count, describe_bytes, describe_duration};
use cli::progress::Progress;
use cli::remote::ServerArguments;
use cli::terminal::text_width;
use cli::wrap::paragraph;
use client::{Client, Estimate, FrameWarning, JobPreview, JobRow, JobState};
use serde_json::json;

/// Seconds of a long poll.
const WAIT_S: u64 = 30;

/// Options of `fathom submit`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description as JSON, with random distributions
    spec: PathBuf,
    /// Wait until the job is finished
    #[arg(long)]
    wait: bool,
    /// Key of the submission: submitting again with the same key returns the same job
    #[arg(long, value_name = "KEY")]
    idempotency_key: Option<String>,
    /// Render it even if its dataset already has all of its images
    #[arg(long)]
    again: bool,
    /// Show the frames, time, bytes and warnings of the job without submitting it
    #[arg(long, conflicts_with_all = ["wait", "idempotency_key", "again"])]
    dry_run: bool,
    /// Print the job as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let spec = files::read(&arguments.spec)?;
    if arguments.dry_run {
        show_preview(&client.preview_job(&spec)?, arguments.json);
        return Ok(());
    }
    let key = arguments.idempotency_key.as_deref();
    let mut job = submit(&client, &spec, key, arguments.again)?;
    if arguments.wait {
        job = wait(&client, &job)?;
    }
    show(&job, arguments.json);
    match arguments.wait {
        true => {
            print_frame_warnings(&client, &job)?;
            all_rendered(&job)
        }
        false => Ok(()),
    }
}

/// Prints the estimated cost of a job.
fn show_preview(preview: &JobPreview, as_json: bool) {
    if as_json {
        println!("{}", json!(preview));
        return;
    }
    for warning in &preview.warnings {
        eprintln!("warning: {warning}");
    }
    let Estimate {
        seconds,
        bytes,
        slots,
        slot_seconds,
        frame_seconds,
        measured,
    } = preview.estimate;
    println!(
        "{} · about {} on {} · price {} of slots, at most {} a frame · about {}; nothing was submitted",
        count(preview.frames, "frame"),
        describe_duration(seconds),
        count(slots, "slot"),
        describe_slot_time(slot_seconds),
        describe_slot_time(frame_seconds),
        describe_bytes(bytes)
    );
    if !measured {
        let remark = "the times are typical figures, since this service has not rendered frames of this kind yet; they may be several \
                      times too low";
        println!("{}", paragraph(remark, 0, text_width()));
    }
}

/// Such as `0.35 s` or `2 min 5 s`.
fn describe_slot_time(seconds: f64) -> String {
    match seconds {
        ..10.0 => format!("{seconds:.2} s"),
        _ => describe_duration(seconds),
    }
}

/// Prints a job on a line, with the beginning of its id, and its digest once it has one.
pub(crate) fn show(job: &JobRow, as_json: bool) {
    if as_json {
        println!("{}", json!(job));
        return;
    }
    let JobRow {
        id,
        dataset,
        state,
        done,
        frames,
        unproven,
        ..
    } = job;
    let unproven = match unproven {
        0 => String::new(),
        unproven => format!(" · {unproven} unproven"),
    };
    let id = shorten_id(id);
    println!(
        "{id} · dataset {dataset} · {state} · {done} of {}{unproven}",
        count(frames, "frame")
    );
    if let Some(digest) = &job.digest {
        println!("digest {digest}");
    }
}

/// Prints the warnings of a job's frames.
pub(crate) fn print_frame_warnings(client: &Client, job: &JobRow) -> Result<(), Failure> {
    for FrameWarning {
        warning,
        frames,
        first_frame,
    } in client.frame_warnings(&job.id)?
    {
        eprintln!(
            "warning: {frames} of {} frames, first {first_frame}: {warning}",
            job.frames
        );
    }
    Ok(())
}

/// Fails if a job has ended without all of its frames.
pub(crate) fn all_rendered(job: &JobRow) -> Result<(), Failure> {
    let JobRow {
        id,
        done,
        failed,
        frames,
        ..
    } = job;
    let id = shorten_id(id);
    match job.state {
        JobState::DoneWithFailures => Err(Failure::SomeFrames {
            failed: *failed,
            frames: *frames,
            hint: format!("; see `fathom errors {id}`"),
        }),
        JobState::Cancelled => {
            Err(anyhow::anyhow!("{id} was cancelled with {done} of {frames} frames done").into())
        }
        JobState::Queued | JobState::Running | JobState::Paused | JobState::Done => Ok(()),
    }
}

/// Submits a job description and prints the warnings about it.
pub(crate) fn submit(
    client: &Client,
    spec: &[u8],
    key: Option<&str>,
    again: bool,
) -> Result<JobRow, Failure> {
    let job = client.submit_job(spec, key, again)?;
    for warning in &job.warnings {
        eprintln!("warning: {warning}");
    }
    Ok(job)
}

/// Waits with long polls until a job is finished.
pub(crate) fn wait(client: &Client, job: &JobRow) -> Result<JobRow, Failure> {
    let id = &job.id;
    let mut progress = Progress::new(&job.dataset, "frames", job.frames);
    // Below the version of every job, so that the first response is immediate.
    let (mut version, mut was_paused) = (0, false);
    loop {
        let job = client.await_job(id, version, WAIT_S)?;
        version = job.version;
        progress.set(job.done + job.failed);
        let is_paused = job.state == JobState::Paused;
        if is_paused && !was_paused {
            let id = shorten_id(id);
            eprintln!("{id} is paused; resume it with `fathom resume {id}`");
        }
        was_paused = is_paused;
        if job.state.has_ended() {
            progress.finish();
            return Ok(job);
        }
    }
}
