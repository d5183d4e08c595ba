//! The process that renders pictures for the service, one after another. The stream of the latest job stays open.

use std::io::{self, BufRead, Read, Write};
use std::sync::Arc;

use renderer::{Engine, File, Stream, StreamError, StreamJob, StreamOptions};
use serde_json::json;
use spec::{ArtifactKind, Encode, Job};

use super::decode::Arrays;
use super::protocol::{
    InputFile, InputRole, Outcome, OutputFile, PictureJob, PictureReply, PictureRequest, ReplyFormat,
    WrongPart,
};

/// Replies to requests until the input ends; the main function of `PROGRAM child pictures`.
///
/// # Errors
/// The input is malformed or the output closed.
pub fn render_pictures(
    engine: &Arc<Engine>,
    mut requests: impl BufRead,
    mut replies: impl Write,
) -> io::Result<()> {
    let mut open: Option<(PictureJob, Stream)> = None;
    let mut line = String::new();
    while requests.read_line(&mut line)? > 0 {
        let request: PictureRequest = serde_json::from_str(&line)?;
        let files = request.files.iter().map(|file| read_file(&mut requests, file));
        let files = files.collect::<io::Result<Vec<_>>>()?;
        let (outcome, files) = match render(engine, &mut open, &request, &files) {
            Ok((outcome, files)) => (outcome, files),
            Err(outcome) => (outcome, Vec::new()),
        };
        let bytes = files.iter().map(|file| file.bytes.len() as u64).sum();
        writeln!(replies, "{}", json!(PictureReply { bytes, outcome }))?;
        files.iter().try_for_each(|file| replies.write_all(&file.bytes))?;
        replies.flush()?;
        line.clear();
    }
    Ok(())
}

fn read_file(requests: &mut impl Read, file: &InputFile) -> io::Result<(InputRole, Vec<u8>)> {
    let mut bytes = Vec::new();
    requests.take(file.bytes).read_to_end(&mut bytes)?;
    match bytes.len() as u64 == file.bytes {
        true => Ok((file.role, bytes)),
        false => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

fn render(
    engine: &Arc<Engine>,
    open: &mut Option<(PictureJob, Stream)>,
    request: &PictureRequest,
    files: &[(InputRole, Vec<u8>)],
) -> Result<(Outcome, Vec<File>), Outcome> {
    let arrays = Arrays::decode(files).map_err(Outcome::Refused)?;
    let mut stream = match open.take() {
        Some((job, stream)) if job == request.job => stream,
        _ => open_stream(engine, &request.job)?,
    };
    let rendered = stream.render(&arrays.describe(request));
    *open = Some((request.job.clone(), stream));
    let mut frame = rendered.map_err(|error| describe_error(error, files))?;
    if request.format != ReplyFormat::Mixed {
        frame.artifacts.retain(|(kind, _)| *kind == ArtifactKind::Rgb);
    }
    let encode = match request.format {
        ReplyFormat::Png => Encode::Png,
        ReplyFormat::Webp => Encode::Webp,
        ReplyFormat::Mixed => read_encode(&request.job)?,
    };
    let (files, record) = frame
        .encode(encode)
        .map_err(|error| Outcome::Failed(error.to_string()))?;
    let described = files.iter().map(|file| OutputFile {
        kind: file.kind.clone(),
        media_type: file.media_type.to_owned(),
        bytes: file.bytes.len() as u64,
    });
    let outcome = Outcome::Rendered {
        files: described.collect(),
        warnings: record.warnings.clone(),
        record: json!(record),
    };
    Ok((outcome, files))
}

fn open_stream(engine: &Arc<Engine>, job: &PictureJob) -> Result<Stream, Outcome> {
    let options = StreamOptions {
        has_metrics: job.has_metrics,
        ..StreamOptions::default()
    };
    let stream_job = StreamJob {
        job: parse(job)?,
        warnings: Vec::new(),
        gives_hfov: job.gives_hfov,
    };
    Stream::with_job(stream_job, options, engine).map_err(|invalid| Outcome::Failed(invalid.to_string()))
}

fn parse(job: &PictureJob) -> Result<Job, Outcome> {
    Job::from_canonical(&job.description).map_err(|invalid| Outcome::Failed(invalid.to_string()))
}

/// The format of pictures of a job.
fn read_encode(job: &PictureJob) -> Result<Encode, Outcome> {
    let frame = parse(job)?.resolve_any(0);
    let frame = frame.map_err(|invalid| Outcome::Failed(invalid.to_string()))?;
    Ok(frame.encode)
}

/// The wrong parts by the names of their fields.
fn describe_error(error: StreamError, files: &[(InputRole, Vec<u8>)]) -> Outcome {
    let errors = match error {
        StreamError::Input(errors) => errors,
        StreamError::Render(error) => return Outcome::Failed(error.to_string()),
    };
    let is_range = files.iter().any(|(role, _)| *role == InputRole::Range);
    let wrong = errors.into_iter().map(|error| {
        let name = match error.field {
            "range_m" if is_range => InputRole::Range.name(),
            field => field,
        };
        WrongPart {
            name: name.to_owned(),
            message: format!("`{name}` {}", error.message),
        }
    });
    Outcome::Refused(wrong.collect())
}
