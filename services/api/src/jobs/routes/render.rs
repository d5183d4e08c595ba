//! `POST /v1/renders`.

use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use catalogue::{JobRow, JobState};
use spec::Job;

use crate::app::{App, Shared};
use crate::http::auth::Caller;
use crate::http::extract::{IdempotencyKey, JsonBytes, PreferredWait};
use crate::http::problem::{Problem, Slug};
use crate::http::stored::Stored;
use crate::images;
use crate::jobs::submit::{Submission, submit};
use crate::jobs::view::JobView;
use crate::jobs::wait::{Until, wait_for_job};
use crate::limits;
use crate::openapi::JobDescription;

/// Where direct renders go unless they name a dataset.
const DATASET: &str = "renders";

/// Render one frame now.
///
/// A job of one frame and high priority, waited for. The answer is the picture itself if `Accept` names an image
/// type, else the image's record.
#[utoipa::path(post, path = "/v1/renders", tag = "jobs",
    params(("Prefer" = Option<String>, Header, description = "`wait=N`: seconds, default 30, at most 60"),
           ("Accept" = Option<String>, Header, description = "`image/*` for the picture"),
           ("Idempotency-Key" = Option<String>, Header, description = "1..=255 characters, kept per token")),
    request_body(content = JobDescription, content_type = "application/json"),
    responses(
        (status = 200, description = "The picture, or the record of the image.",
         content((serde_json::Value = "application/json"), (Vec<u8> = "image/png"))),
        (status = 202, description = "Not ready in time; `Location` is the job.", body = JobView),
        (status = 409, response = crate::openapi::Problem),
        (status = 422, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(app): State<Shared>,
    Extension(caller): Extension<Caller>,
    PreferredWait(wait): PreferredWait,
    key: Option<IdempotencyKey>,
    headers: HeaderMap,
    JsonBytes(body): JsonBytes,
) -> Result<Response, Problem> {
    let job = Job::parse(&in_dataset(&body), &app.vocabulary())?;
    if job.frames() != 1 {
        return Err(Problem::field(
            "/count",
            format!("a render has one frame, this describes {}", job.frames()),
        ));
    }
    let idempotency_key = key.map(|IdempotencyKey(key)| key);
    let row = submit(
        &app,
        Submission {
            job,
            priority: limits::RENDER_PRIORITY,
            caller,
            idempotency_key,
        },
    )
    .await?;
    let row = wait_for_job(
        &app,
        &row.id,
        wait.unwrap_or(limits::DEFAULT_RENDER_WAIT),
        Until::Ended,
    )
    .await?;
    match row.state {
        JobState::Done => picture_or_record(&app, &headers, &row).await,
        JobState::DoneWithFailures => Err(why_failed(&app, &row).await?),
        _ => Ok(not_yet(row)),
    }
}

async fn picture_or_record(app: &App, headers: &HeaderMap, row: &JobRow) -> Result<Response, Problem> {
    let location = [(
        HeaderName::from_static("content-location"),
        format!("/v1/images/{}/0", row.id),
    )];
    if !wants_picture(headers) {
        let image = app
            .catalogue
            .image(&row.id, 0)
            .await?
            .ok_or_else(|| Problem::internal(&"a done frame has no image"))?;
        return Ok((location, Json(images::view(image))).into_response());
    }
    let entry = app.catalogue.artifact(&row.id, 0, "rgb").await?;
    let entry = entry
        .ok_or_else(|| Problem::field("/artifacts", "name `rgb` among the artifacts to get the picture"))?;
    let bytes = images::bytes(app, &entry).await?;
    let stored = Stored {
        digest: &entry.digest,
        media_type: &entry.media_type,
        bytes,
    };
    Ok((location, stored.answer(&HeaderMap::new())?).into_response())
}

async fn why_failed(app: &App, row: &JobRow) -> Result<Problem, Problem> {
    let failures = app.catalogue.failures(&row.id, None, 1).await?;
    let error = failures
        .into_iter()
        .next()
        .map_or_else(|| "no reason is known".to_owned(), |failure| failure.error);
    Ok(Problem::new(Slug::RenderFailed, error).with("job", row.id.clone()))
}

fn not_yet(row: JobRow) -> Response {
    let location = [(header::LOCATION, format!("/v1/jobs/{}", row.id))];
    (StatusCode::ACCEPTED, location, Json(JobView::from(row))).into_response()
}

fn wants_picture(headers: &HeaderMap) -> bool {
    let lines = headers
        .get_all(header::ACCEPT)
        .into_iter()
        .filter_map(|value| value.to_str().ok());
    lines
        .flat_map(|line| line.split(','))
        .any(|kind| kind.trim().starts_with("image/"))
}

/// The description with the usual dataset, if it names none. Text that is no object stays as it is: the description's
/// own reader says what is wrong with it.
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
