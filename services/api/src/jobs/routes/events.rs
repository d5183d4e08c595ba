use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{KeepAlive, Sse};
use axum::response::{IntoResponse, Response};

use crate::http::{Path, Problem, Slug, State, Topic};
use crate::jobs::Jobs;
use crate::jobs::follow::{Follow, Seen};
use crate::limits;

/// Follow a job as server-sent events.
///
/// `state` contains the job and is sent first and at each change of state. `progress` contains `done`, `failed` and
/// `frames`, at most twice a second. `problem` reports newly failed frames: their number, and the errors of some.
/// After 15 s without events a comment is sent. The stream ends with the job; after its end the response is 204.
/// `Last-Event-ID` resumes after the last event. Events describe the present state rather than changes, so a client
/// that reconnects misses nothing.
#[utoipa::path(get, path = "/v1/jobs/{id}/events", tag = "jobs", operation_id = "follow_job",
    params(("id" = String, Path, description = "`job_…`"),
           ("Last-Event-ID" = Option<String>, Header, description = "Id of the last event that was received")),
    responses((status = 200, description = "The events.", content_type = "text/event-stream", body = String),
              (status = 204, description = "The job has ended and all events were sent.")))]
pub(crate) async fn events(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let job = jobs.get(&id).await?;
    let seen = last_event(&headers)?;
    if job.state.has_ended() && seen == Some(Seen::new(&job)) {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let events = Follow::new(jobs, id, seen).events();
    let heartbeat = KeepAlive::new().interval(limits::HEARTBEAT).text("");
    Ok(Sse::new(events).keep_alive(heartbeat).into_response())
}

fn last_event(headers: &HeaderMap) -> Result<Option<Seen>, Problem> {
    let Some(id) = headers.get("last-event-id").filter(|id| !id.is_empty()) else {
        return Ok(None);
    };
    let seen = id.to_str().ok().and_then(Seen::parse);
    seen.map(Some).ok_or_else(|| {
        let id = String::from_utf8_lossy(id.as_bytes());
        let id: String = id.chars().take(40).collect();
        Problem::new(
            Slug::InvalidHeader,
            format!("Last-Event-ID is `{id}`; must be the id of an event, such as `12.0`"),
        )
    })
}
