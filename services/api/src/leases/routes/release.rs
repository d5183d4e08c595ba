//! `POST /v1/worker/release`.

use axum::extract::State;
use proto::message::Release;
use proto::wire::{ReleaseRequest, ReleaseResponse};

use crate::app::Shared;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;

/// Takes a lease back. No attempt is burned; a stale token changes nothing.
pub(crate) async fn release(
    State(app): State<Shared>,
    Checked(Release { token, reason }, _): Checked<ReleaseRequest, Release>,
) -> Result<ProtoBody<ReleaseResponse>, Problem> {
    tracing::debug!(token, reason, "lease handed back");
    app.dispatch.release(token);
    Ok(ProtoBody(ReleaseResponse {}))
}
