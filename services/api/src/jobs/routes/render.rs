use std::sync::Arc;
use std::time::Duration;

use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use catalogue::{JobRow, JobState};

use crate::http::extract::{PreferredWait, Submitter, listed};
use crate::http::located::located;
use crate::http::stored::GUARDED;
use crate::http::{Json, JsonBytes, MultipartBody, Problem, Slug, State, Topic};
use crate::jobs::Jobs;
use crate::jobs::direct::Unanswered;
use crate::jobs::routes::picture::render_picture;
use crate::jobs::submit::Submission;
use crate::jobs::wait::Until;
use crate::limits;
use crate::openapi::{Bytes, ImageRecord, JobDescription};
use crate::processes::live::Live;
use crate::renders::form::PictureUpload;

/// Dataset of direct renders without one.
const DATASET: &str = "renders";

/// Render one frame now.
///
/// Submits a job of one frame that is rendered before the caller's other jobs, and waits for it. Small images of procedural scenes that are not
/// stored are rendered without a job. The response is the image if `Accept` names an image type, else its record. The
/// image is only stored if the description names a dataset or the request has an `Idempotency-Key`;
/// `Content-Location` is then its location. A render that exceeds the wait becomes the ordinary job in `Location`. If the
/// client disconnects first, the job is cancelled, unless an `Idempotency-Key` can return it later.
///
/// With `multipart/form-data`, the frame is that of a stream over the picture of the form, and nothing is stored. The
/// response is the picture as PNG or WebP, or `multipart/mixed` with the record and all artifacts of the job.
/// `Fathom-Warnings` lists warnings, such as stages skipped without distances.
#[utoipa::path(post, path = "/v1/renders", tag = "jobs", operation_id = "render_frame",
    params(("Prefer" = Option<String>, Header, description = "`wait=N`: seconds, default 30, at most 60"),
           ("Accept" = Option<String>, Header,
            description = "`image/*` for the image; of a form `image/png` (default), `image/webp` or `multipart/mixed`"),
           ("Idempotency-Key" = Option<String>, Header, description = "1..=255 characters, kept per token")),
    request_body(content((JobDescription = "application/json"), (PictureUpload = "multipart/form-data"))),
    responses(
        (status = 200, description = "The image, or its record.",
         content((ImageRecord = "application/json"), (Bytes = "image/jpeg"), (Bytes = "image/png"), (Bytes = "image/webp"),
                  (Bytes = "multipart/mixed"))),
        (status = 202, description = "Not ready in time; `Location` is the job.", body = JobRow),
        (status = 409, response = crate::openapi::Problem),
        (status = 429, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(jobs): Topic<Jobs>,
    submitter: Submitter,
    PreferredWait(wait): PreferredWait,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Problem> {
    let wait = wait.unwrap_or(limits::DEFAULT_RENDER_WAIT);
    if is_form(&headers) {
        let MultipartBody(body) = MultipartBody::from_request(request, &()).await?;
        return render_picture(&jobs, &submitter, &headers, wait, body).await;
    }
    let JsonBytes(body) = JsonBytes::from_request(request, &()).await?;
    if body.len() > limits::JSON_BYTES {
        return Err(Problem::new(
            Slug::TooLarge,
            "the body exceeds the limit of this route",
        ));
    }
    render_described(&jobs, submitter, wait, &headers, &body).await
}

/// Renders the frame of a description.
async fn render_described(
    jobs: &Arc<Jobs>,
    submitter: Submitter,
    wait: Duration,
    headers: &HeaderMap,
    body: &[u8],
) -> Result<Response, Problem> {
    let job = jobs.parse(&in_dataset(body)).await?;
    if job.frames() != 1 {
        let message = format!(
            "a render has one frame, but the description has {}; submit a job instead",
            job.frames()
        );
        return Err(Problem::field("/count", message));
    }
    let is_kept = names_dataset(body) || submitter.idempotency_key.is_some();
    if !is_kept && wait >= Live::LIMIT && wants_picture(headers) {
        jobs.check_runtime(&job)?;
        if let Some(live) = &jobs.processes.live
            && let Some(drawn) = live.draw(&job, &submitter.owner).await
        {
            let media_type = [(header::CONTENT_TYPE, drawn.media_type)];
            return Ok((media_type, GUARDED, drawn.bytes).into_response());
        }
    }
    let submission = Submission {
        submitter,
        priority: limits::RENDER_PRIORITY,
        // A temporary render needs a separate job.
        again: true,
    };
    let unanswered = match (submission.submitter.idempotency_key.is_some(), is_kept) {
        (true, _) => Unanswered::Continue,
        (false, true) => Unanswered::Cancel,
        (false, false) => Unanswered::Delete,
    };
    let (submitted, request) = jobs.submit_direct(job, submission, unanswered).await?;
    let ended = async {
        let row = jobs.wait_on(submitted, wait, Until::Ended).await?;
        let response = respond(jobs, headers, &row, is_kept).await?;
        Ok::<_, Problem>((row, response))
    };
    let (row, mut response) = match ended.await {
        Ok(ended) => ended,
        Err(problem) => {
            request.fail();
            return Err(problem);
        }
    };
    request.end();
    if !is_kept && matches!(row.state, JobState::Done | JobState::DoneWithFailures) {
        jobs.delete(row.id).await?;
        response.headers_mut().remove(CONTENT_LOCATION);
    }
    Ok(response)
}

/// The image or record of an ended job, why it failed, or the location of a job that continues.
async fn respond(jobs: &Jobs, headers: &HeaderMap, row: &JobRow, is_kept: bool) -> Result<Response, Problem> {
    let id = row.id.as_str();
    match row.state {
        JobState::Done => picture_or_record(jobs, headers, id).await,
        JobState::DoneWithFailures => {
            let problem = why_failed(jobs, id).await?;
            Ok(match is_kept {
                true => problem.with_member("job", id).into_response(),
                false => problem.into_response(),
            })
        }
        _ => {
            let location = format!("/v1/jobs/{id}");
            Ok(located(StatusCode::ACCEPTED, location, row.clone()).into_response())
        }
    }
}

const CONTENT_LOCATION: HeaderName = HeaderName::from_static("content-location");

async fn picture_or_record(jobs: &Jobs, headers: &HeaderMap, job: &str) -> Result<Response, Problem> {
    let location = [(CONTENT_LOCATION, format!("/v1/images/{job}/0"))];
    if !wants_picture(headers) {
        return Ok((location, Json(jobs.images.get(job, 0).await?)).into_response());
    }
    let entry = jobs.catalogue.artifact(job, 0, "rgb").await?;
    let entry = entry
        .ok_or_else(|| Problem::field("/artifacts", "`artifacts` lacks `rgb`; add it to get the image"))?;
    let stored = jobs.images.stored(entry).await?;
    Ok((location, stored.response(&HeaderMap::new())?).into_response())
}

async fn why_failed(jobs: &Jobs, job: &str) -> Result<Problem, Problem> {
    let failure = jobs.catalogue.failures(job, None, 1).await?.pop();
    let error = failure.map_or_else(|| "no reason was recorded".to_owned(), |failure| failure.error);
    Ok(Problem::new(Slug::RenderFailed, error))
}

fn is_form(headers: &HeaderMap) -> bool {
    let content_type = headers
        .get(header::CONTENT_TYPE)
        .and_then(|value| value.to_str().ok());
    let essence = content_type
        .and_then(|text| text.split(';').next())
        .map(str::trim);
    essence.is_some_and(|text| text.eq_ignore_ascii_case("multipart/form-data"))
}

fn wants_picture(headers: &HeaderMap) -> bool {
    listed(headers, header::ACCEPT).any(|kind| kind.starts_with("image/"))
}

/// Whether a valid description names a dataset.
fn names_dataset(body: &[u8]) -> bool {
    let parsed: Result<serde_json::Map<String, serde_json::Value>, _> = serde_json::from_slice(body);
    parsed.is_ok_and(|object| object.contains_key("dataset"))
}

/// The description with the default dataset if it has none. Other text is unchanged; parsing it reports the errors.
fn in_dataset(body: &[u8]) -> Vec<u8> {
    let parsed: Result<serde_json::Map<_, _>, _> = serde_json::from_slice(body);
    match (parsed, body.iter().position(|byte| *byte == b'{')) {
        (Ok(object), Some(brace)) if !object.contains_key("dataset") => {
            let (head, tail) = body.split_at(brace + 1);
            let comma = if object.is_empty() { "" } else { "," };
            [head, format!("\"dataset\":\"{DATASET}\"{comma}").as_bytes(), tail].concat()
        }
        _ => body.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_description_without_a_dataset_gets_the_usual_one() {
        let text = |body: &str| String::from_utf8(in_dataset(body.as_bytes())).unwrap();
        assert_eq!(text(" { }"), r#" {"dataset":"renders" }"#);
        assert_eq!(
            text(r#"{"seed":1,"seed":2}"#),
            r#"{"dataset":"renders","seed":1,"seed":2}"#
        );
        for unchanged in [r#"{"dataset":"x"}"#, "[{}]", "{", ""] {
            assert_eq!(text(unchanged), unchanged);
        }
    }
}
