//! `POST /v1/worker/fail`.

use axum::extract::State;
use proto::message::Fail;
use proto::wire::{FailRequest, FailResponse};

use super::stale_lease;
use crate::app::Shared;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::strikes;

/// Reports a failed attempt: the frame is tried again after a pause, or given up.
pub(crate) async fn fail(
    State(app): State<Shared>,
    Checked(failure, _): Checked<FailRequest, Fail>,
) -> Result<ProtoBody<FailResponse>, Problem> {
    let Fail {
        claim,
        error,
        retryable,
        ..
    } = failure;
    let event = app.dispatch.fail(&claim, retryable, &error);
    let event = event.map_err(|_| stale_lease(&claim))?;
    strikes::record(&app, vec![event]).await;
    Ok(ProtoBody(FailResponse {}))
}
