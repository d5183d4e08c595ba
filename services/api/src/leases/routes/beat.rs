//! `POST /v1/worker/beat`.

use std::sync::Arc;

use axum::extract::State;
use proto::message::BeatOf;
use proto::wire::{BeatRequest, BeatResponse};

use super::unknown_worker;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::Leases;

/// Prolongs the worker's leases; says which were cancelled and which are lost. Touches no database.
pub(crate) async fn beat(
    State(leases): State<Arc<Leases>>,
    Checked(BeatOf { worker_id, tokens }, _): Checked<BeatRequest, BeatOf>,
) -> Result<ProtoBody<BeatResponse>, Problem> {
    let beat = leases
        .dispatch
        .beat(&worker_id, &tokens)
        .map_err(unknown_worker)?;
    let (cancelled, lost) = (beat.cancelled, beat.lost);
    Ok(ProtoBody(BeatResponse { cancelled, lost }))
}
