//! `POST /v1/worker/register`.

use axum::extract::State;
use proto::message::{Register, Registered};
use proto::wire::{RegisterRequest, RegisterResponse};

use crate::app::Shared;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::table::TERM_MS;
use crate::limits;

/// Takes a worker on. It registers again whenever a call answers `unknown-worker`.
pub(crate) async fn register(
    State(app): State<Shared>,
    Checked(about, _): Checked<RegisterRequest, Register>,
) -> Result<ProtoBody<RegisterResponse>, Problem> {
    tracing::info!(
        worker = about.name,
        slots = about.slots,
        version = about.code_version,
        "worker registered"
    );
    let worker_id = app.dispatch.register(about);
    let registered = Registered {
        worker_id,
        lease_term_ms: TERM_MS,
        beat_ms: limits::BEAT_MS,
    };
    Ok(ProtoBody(registered.into()))
}
