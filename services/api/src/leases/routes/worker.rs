use std::time::Duration;

use axum::Extension;
use catalogue::Page;
use wire::messages::{
    BeatRequest, BeatResponse, LeaseRequest, LeaseResponse, RegisterRequest, RegisterResponse, ReleaseRequest,
};

use crate::http::auth::Caller;
use crate::http::{Json, Problem, Protobuf, Slug, State, Topic};
use crate::leases::Leases;
use crate::leases::dispatch::Unknown;
use crate::leases::table::TERM_MS;
use crate::leases::worker::Worker;
use crate::limits;
use crate::processes::fleet::OWN_WORKER;

/// Registers a worker. It registers again whenever a response is `unknown-worker`.
pub(crate) async fn register(
    State(leases): Topic<Leases>,
    Extension(caller): Extension<Caller>,
    Protobuf(about): Protobuf<RegisterRequest>,
) -> Result<Protobuf<RegisterResponse>, Problem> {
    let RegisterRequest {
        name,
        slots,
        code_version,
        ..
    } = &about;
    tracing::info!(worker = name, slots, version = code_version, "worker registered");
    if !caller.is_own_worker && is_own_name(name) {
        let detail = format!("`{name}` is reserved for the service's workers; choose another name");
        return Err(Problem::new(Slug::Forbidden, detail));
    }
    let detail = format!("worker `{name}` was dismissed for rejected reports");
    let worker_id = leases.dispatch.register(about, caller.is_own_worker);
    Ok(Protobuf(RegisterResponse {
        worker_id: worker_id.ok_or_else(|| Problem::new(Slug::Forbidden, detail))?,
        lease_term_ms: TERM_MS,
        beat_ms: limits::BEAT_MS,
        protocol: wire::VERSION,
    }))
}

/// Waits for frames to render and leases them, without database access.
pub(crate) async fn lease(
    State(leases): Topic<Leases>,
    Protobuf(request): Protobuf<LeaseRequest>,
) -> Result<Protobuf<LeaseResponse>, Problem> {
    let wait = Duration::from_millis(request.wait_ms.into()).min(limits::MAX_WAIT);
    let granted = tokio::select! {
        granted = leases.dispatch.lease(&request.worker_id, wait, request.frame_ms) => granted.map_err(unknown_worker)?,
        // An empty response would cause an immediate retry.
        () = leases.stop.cancelled() => return Err(Problem::overloaded("the service is stopping")),
    };
    let lease = granted.map(|granted| {
        let lease = granted.hand_over();
        faults::point("lease.granted");
        lease
    });
    Ok(Protobuf(LeaseResponse { lease }))
}

/// Extends the worker's leases. Returns the cancelled and lost ones, and waits for one if requested. No database
/// access.
pub(crate) async fn beat(
    State(leases): Topic<Leases>,
    Protobuf(beat): Protobuf<BeatRequest>,
) -> Result<Protobuf<BeatResponse>, Problem> {
    let wait = Duration::from_millis(beat.wait_ms.into()).min(limits::MAX_WAIT);
    let response = tokio::select! {
        response = leases.dispatch.beat(&beat.worker_id, &beat.tokens, wait) => response,
        () = leases.stop.cancelled() => Ok(BeatResponse::default()),
    };
    response.map(Protobuf).map_err(unknown_worker)
}

/// `local-1`, `local-2`, …
fn is_own_name(name: &str) -> bool {
    let number = name.strip_prefix(OWN_WORKER);
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Takes a lease back without counting an attempt; a stale token has no effect.
pub(crate) async fn release(
    State(leases): Topic<Leases>,
    Protobuf(ReleaseRequest { token, reason }): Protobuf<ReleaseRequest>,
) {
    tracing::debug!(token, reason, "lease returned");
    leases.dispatch.free(|table, now| table.release(token, now));
}

fn unknown_worker(_: Unknown) -> Problem {
    let detail = "the worker is not registered since the service started; register again";
    Problem::new(Slug::UnknownWorker, detail)
}

/// List the registered workers and those of the broker on one page.
#[utoipa::path(get, path = "/v1/workers", tag = "operations", operation_id = "list_workers",
    responses((status = 200, description = "All workers.", body = Page<Worker>)))]
pub(crate) async fn list(State(leases): Topic<Leases>) -> Json<Page<Worker>> {
    Json(Page::whole(leases.workers()))
}
