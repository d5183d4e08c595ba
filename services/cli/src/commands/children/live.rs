//! `fathom child live`: renders preview frames for the service, one after another.

use std::io::{BufRead, Write};

use anyhow::Context;
use cli::exit::Failure;
use renderer::{SceneSource, Slot};
use serde::Deserialize;
use serde_json::json;
use spec::Job;

use super::engine::EngineArguments;

/// A line of standard input.
#[derive(Deserialize)]
struct Request {
    spec: String,
}

/// Replies to each line with a line of JSON and, unless that has an error, the bytes of the picture. It ends with its input.
pub(crate) fn run(arguments: &EngineArguments) -> Result<(), Failure> {
    let mut slot = Slot::new(&arguments.engine()?);
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line.context("standard input cannot be read")?;
        let (head, bytes) = match picture(&mut slot, &line) {
            Ok((media_type, bytes)) => (json!({"media_type": media_type, "bytes": bytes.len()}), bytes),
            Err(failure) => (json!({"error": failure.to_string()}), Vec::new()),
        };
        let written = writeln!(out, "{head}").and_then(|()| out.write_all(&bytes));
        written
            .and_then(|()| out.flush())
            .context("standard output cannot be written")?;
    }
    Ok(())
}

fn picture(slot: &mut Slot, line: &str) -> Result<(&'static str, Vec<u8>), Failure> {
    let request: Request = serde_json::from_str(line).context("the request cannot be read")?;
    let job = Job::from_canonical(&request.spec).map_err(Failure::input)?;
    let frame = job.resolve(0).map_err(Failure::input)?;
    let rendered = slot
        .attempt(&frame, &SceneSource::Local)
        .map_err(Failure::input)?;
    let rgb = rendered.files.into_iter().find(|file| file.kind == "rgb");
    let rgb = rgb.ok_or_else(|| Failure::BadInput("the frame has no picture".to_owned()))?;
    Ok((rgb.media_type, rgb.bytes))
}
