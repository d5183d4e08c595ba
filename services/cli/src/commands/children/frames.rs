//! `fathom child frames`: the child of a supervisor. It reads the job and then frame numbers, a line each, and writes
//! [`Message`]s. It ends when its input does, so it never outlives its supervisor.

use std::io::{BufRead, stdin, stdout};
use std::process;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread;

use anyhow::Context;
use cli::exit::Failure;
use cli::styles::StyleArguments;
use renderer::{Engine, SceneSource, Slot, extension};
use serde_json::json;
use sets::{Message, ParcelFile};
use spec::Job;

/// Options of `fathom child frames`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Frames rendered side by side
    #[arg(long)]
    slots: usize,
    #[command(flatten)]
    style: StyleArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut lines = stdin().lock().lines();
    let text = lines
        .next()
        .context("the supervisor sends no job")?
        .context("cannot read the job")?;
    let job = Arc::new(Job::from_canonical(&text).map_err(Failure::input)?);
    let library = arguments.style.library()?;
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let (send, frames) = mpsc::channel::<u64>();
    let frames = Arc::new(Mutex::new(frames));
    for _ in 0..arguments.slots {
        let (job, engine, frames) = (Arc::clone(&job), Arc::clone(&engine), Arc::clone(&frames));
        thread::spawn(move || {
            let mut slot = Slot::new(&engine);
            let next = || frames.lock().unwrap_or_else(PoisonError::into_inner).recv();
            while let Ok(frame) = next() {
                write_message(&Message::Begun { frame });
                write_message(&render(&job, &mut slot, frame));
            }
        });
    }
    for line in lines {
        let line = line.context("cannot read frame numbers")?;
        let frame = line
            .parse()
            .with_context(|| format!("`{line}` is not a frame number"))?;
        send.send(frame).context("the slots are gone")?;
    }
    Ok(())
}

fn render(job: &Job, slot: &mut Slot, index: u64) -> Message {
    let failed = |error: String, retryable| Message::Failed {
        frame: index,
        error,
        retryable,
    };
    let frame = match job.resolve(index) {
        Ok(frame) => frame,
        Err(invalid) => return failed(invalid.to_string(), false),
    };
    let mut rendered = match slot.attempt(&frame, &SceneSource::Local) {
        Ok(rendered) => rendered,
        Err(error) => return failed(error.to_string(), error.retryable()),
    };
    if faults::frame_point("record.wrong", index) {
        rendered.record.plan = json!([]);
    }
    let record = match serde_json::to_vec(&rendered.record) {
        Ok(record) => record,
        Err(error) => return failed(format!("the record cannot be written: {error}"), false),
    };
    let files = rendered.files.into_iter().map(|file| ParcelFile {
        extension: extension(file.media_type).to_owned(),
        kind: file.kind,
        bytes: file.bytes,
    });
    Message::Image {
        frame: index,
        record,
        files: files.collect(),
    }
}

/// Writes a message; exits if the supervisor is gone.
fn write_message(message: &Message) {
    if message.write(&mut stdout().lock()).is_err() {
        process::exit(0);
    }
}
