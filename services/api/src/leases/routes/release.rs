//! `POST /v1/worker/release`.

use std::sync::Arc;

use axum::extract::State;
use proto::message::Release;
use proto::wire::{ReleaseRequest, ReleaseResponse};

use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::Leases;

/// Takes a lease back. No attempt is burned; a stale token changes nothing.
pub(crate) async fn release(
    State(leases): State<Arc<Leases>>,
    Checked(Release { token, reason }, _): Checked<ReleaseRequest, Release>,
) -> Result<ProtoBody<ReleaseResponse>, Problem> {
    tracing::debug!(token, reason, "lease handed back");
    leases.dispatch.free(|table, now| table.release(token, now));
    Ok(ProtoBody(ReleaseResponse {}))
}
