//! `POST /v1/worker/register`, `lease`, `beat` and `release`; `GET /v1/workers`.

use std::time::Duration;

use catalogue::Page;
use proto::wire::{
    BeatRequest, BeatResponse, LeaseRequest, LeaseResponse, RegisterRequest, RegisterResponse, ReleaseRequest,
};

use crate::http::{Json, Problem, Protobuf, Slug, State, Topic};
use crate::leases::dispatch::Unknown;
use crate::leases::table::TERM_MS;
use crate::leases::{Leases, Worker};
use crate::limits;

/// Registers a worker. It registers again whenever a response is `unknown-worker`.
pub(crate) async fn register(
    State(leases): Topic<Leases>,
    Protobuf(about): Protobuf<RegisterRequest>,
) -> Result<Protobuf<RegisterResponse>, Problem> {
    let RegisterRequest {
        name,
        slots,
        code_version,
        ..
    } = &about;
    tracing::info!(worker = name, slots, version = code_version, "worker registered");
    let detail = format!("worker `{name}` was dismissed: what it said of frames could not be true");
    let worker_id = leases.dispatch.register(about);
    Ok(Protobuf(RegisterResponse {
        worker_id: worker_id.ok_or_else(|| Problem::new(Slug::Forbidden, detail))?,
        lease_term_ms: TERM_MS,
        beat_ms: limits::BEAT_MS,
        protocol: proto::VERSION,
    }))
}

/// Waits for frames to render and leases them. Touches no database.
pub(crate) async fn lease(
    State(leases): Topic<Leases>,
    Protobuf(request): Protobuf<LeaseRequest>,
) -> Result<Protobuf<LeaseResponse>, Problem> {
    let wait = Duration::from_millis(request.wait_ms.into()).min(limits::MAX_WAIT);
    let granted = tokio::select! {
        granted = leases.dispatch.lease(&request.worker_id, wait, request.frame_ms) => granted.map_err(unknown_worker)?,
        // An empty response would be followed by the next request at once.
        () = leases.stop.cancelled() => return Err(Problem::overloaded("the service is stopping")),
    };
    let lease = granted.map(|granted| {
        let lease = granted.hand_over();
        faults::point("lease.granted");
        lease
    });
    Ok(Protobuf(LeaseResponse { lease }))
}

/// Prolongs the worker's leases; names those that were cancelled or lost. Touches no database.
pub(crate) async fn beat(
    State(leases): Topic<Leases>,
    Protobuf(beat): Protobuf<BeatRequest>,
) -> Result<Protobuf<BeatResponse>, Problem> {
    let beat = leases.dispatch.beat(&beat.worker_id, &beat.tokens);
    beat.map(Protobuf).map_err(unknown_worker)
}

/// Takes a lease back. No attempt is burned; a stale token changes nothing.
pub(crate) async fn release(
    State(leases): Topic<Leases>,
    Protobuf(ReleaseRequest { token, reason }): Protobuf<ReleaseRequest>,
) {
    tracing::debug!(token, reason, "lease handed back");
    leases.dispatch.free(|table, now| table.release(token, now));
}

fn unknown_worker(_: Unknown) -> Problem {
    let detail = "this life of the service does not know the worker; register again";
    Problem::new(Slug::UnknownWorker, detail)
}

/// List the workers that are registered and those of the broker, all on one page.
#[utoipa::path(get, path = "/v1/workers", tag = "operations", operation_id = "list_workers",
    responses((status = 200, description = "All workers.", body = Page<Worker>)))]
pub(crate) async fn list(State(leases): Topic<Leases>) -> Json<Page<Worker>> {
    Json(Page::whole(leases.workers()))
}
