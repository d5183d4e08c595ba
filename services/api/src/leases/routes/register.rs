//! `POST /v1/worker/register`.

use std::sync::Arc;

use axum::extract::State;
use proto::message::{Register, Registered};
use proto::wire::{RegisterRequest, RegisterResponse};

use crate::http::extract::{Checked, ProtoBody};
use crate::leases::Leases;
use crate::leases::table::TERM_MS;
use crate::limits;

/// Takes a worker on. It registers again whenever a call answers `unknown-worker`.
pub(crate) async fn register(
    State(leases): State<Arc<Leases>>,
    Checked(about, _): Checked<RegisterRequest, Register>,
) -> ProtoBody<RegisterResponse> {
    let Register {
        name,
        slots,
        code_version,
        ..
    } = &about;
    tracing::info!(worker = name, slots, version = code_version, "worker registered");
    let registered = Registered {
        worker_id: leases.dispatch.register(about),
        lease_term_ms: TERM_MS,
        beat_ms: limits::BEAT_MS,
    };
    ProtoBody(registered.into())
}
