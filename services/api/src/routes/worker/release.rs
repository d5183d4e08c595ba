//! `POST /v1/worker/release`.

use axum::extract::State;
use proto::message::Release;
use proto::wire::{ReleaseRequest, ReleaseResponse};

use crate::extract::{Proto, ProtoBody};
use crate::problem::Problem;
use crate::state::Shared;

/// Takes a lease back. No attempt is burned; a stale token changes nothing.
pub(crate) async fn release(
    State(app): State<Shared>,
    Proto(request): Proto<ReleaseRequest>,
) -> Result<ProtoBody<ReleaseResponse>, Problem> {
    let Release { token, reason } = request.try_into()?;
    tracing::debug!(token, reason, "lease handed back");
    app.dispatch.release(token);
    Ok(ProtoBody(ReleaseResponse {}))
}
