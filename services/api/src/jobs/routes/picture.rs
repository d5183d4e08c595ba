//! Renders the picture of a form for `POST /v1/renders`.

use std::time::Duration;

use axum::extract::Multipart;
use axum::http::HeaderMap;
use axum::response::Response;
use spec::Vocabulary;

use crate::http::Problem;
use crate::http::extract::Submitter;
use crate::http::problem::Slug;
use crate::jobs::Jobs;
use crate::processes::pictures::PictureMessage;
use crate::renders::form::PictureForm;
use crate::renders::protocol::ReplyFormat;
use crate::renders::reply::{choose_format, respond};

/// Renders a picture. It has the limits and the price of a direct render, but no job.
pub(super) async fn render_picture(
    jobs: &Jobs,
    submitter: &Submitter,
    headers: &HeaderMap,
    time: Duration,
    body: Multipart,
) -> Result<Response, Problem> {
    if submitter.idempotency_key.is_some() {
        let detail = "Idempotency-Key is for renders that are stored; a form stores nothing: leave it out";
        return Err(Problem::new(Slug::InvalidHeader, detail));
    }
    let format = choose_format(headers)?;
    // The picture takes the place of a file of this machine.
    let vocabulary = Vocabulary {
        local: true,
        ..jobs.vocabulary()
    };
    let form = PictureForm::read(body, &vocabulary, format).await?;
    let frame = form.job.job.resolve_any(0)?;
    if format == ReplyFormat::Webp && frame.camera.bits > 8 {
        let message = format!(
            "`camera.bits` is {}, but image/webp has 8; accept image/png or multipart/mixed",
            frame.camera.bits
        );
        return Err(Problem::field("/frame/camera/bits", message));
    }
    jobs.check_runtime(&form.job.job)?;
    let Some(process) = &jobs.processes.pictures else {
        let detail = "this service renders nothing itself (`--workers 0`); upload the picture as a scene and submit a job";
        return Err(Problem::new(Slug::RenderFailed, detail));
    };
    let _reservation = jobs.admit_picture(&submitter.owner, &frame, form.pixels).await?;
    let message = PictureMessage {
        bytes: form.message()?,
        pixels: form.pixels,
        time,
    };
    let (reply, files) = process.render(message, &submitter.owner).await?;
    respond(format, reply, form.job.warnings, files)
}
