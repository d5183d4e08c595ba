//! `POST /v1/worker/lease`.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use proto::message::WantLease;
use proto::wire::{LeaseRequest, LeaseResponse};

use super::unknown_worker;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::Leases;
use crate::limits;

/// Waits for frames to render and leases them. Touches no database.
pub(crate) async fn lease(
    State(leases): State<Arc<Leases>>,
    Checked(want, _): Checked<LeaseRequest, WantLease>,
) -> Result<ProtoBody<LeaseResponse>, Problem> {
    let WantLease {
        worker_id,
        wait_ms,
        frame_ms,
    } = want;
    let wait = Duration::from_millis(wait_ms.into()).min(limits::MAX_WAIT);
    let granted = tokio::select! {
        granted = leases.dispatch.lease(&worker_id, wait, frame_ms) => granted.map_err(unknown_worker)?,
        // An empty response would be followed by the next request at once.
        () = leases.stop.cancelled() => return Err(Problem::overloaded("the service is stopping")),
    };
    let lease = granted.map(|granted| {
        let lease = granted.hand_over();
        faults::point("lease.granted");
        lease.into()
    });
    Ok(ProtoBody(LeaseResponse { lease }))
}
