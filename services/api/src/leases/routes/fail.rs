//! `POST /v1/worker/fail`.

use std::sync::Arc;

use axum::extract::State;
use proto::message::Fail;
use proto::wire::{FailRequest, FailResponse};

use super::stale_lease;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::Leases;

/// Reports a failed attempt: the frame is tried again after a pause, or given up.
pub(crate) async fn fail(
    State(leases): State<Arc<Leases>>,
    Checked(failure, _): Checked<FailRequest, Fail>,
) -> Result<ProtoBody<FailResponse>, Problem> {
    let Fail {
        claim,
        error,
        retryable,
        ..
    } = failure;
    let event = leases
        .dispatch
        .table(|table, now| table.fail(&claim, retryable, &error, now));
    let event = event.map_err(|_| stale_lease(&claim))?;
    leases.record_strikes(vec![event]).await;
    Ok(ProtoBody(FailResponse {}))
}
