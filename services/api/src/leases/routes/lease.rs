//! `POST /v1/worker/lease`.

use std::time::Duration;

use crate::leases::table::Grant;
use axum::extract::State;
use proto::message::{Lease, WantLease};
use proto::wire::{LeaseRequest, LeaseResponse};

use super::unknown_worker;
use crate::app::Shared;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::table::TERM_MS;
use crate::limits;

/// Waits for frames to render and leases them.
pub(crate) async fn lease(
    State(app): State<Shared>,
    Checked(want, _): Checked<LeaseRequest, WantLease>,
) -> Result<ProtoBody<LeaseResponse>, Problem> {
    let WantLease {
        worker_id,
        wait_ms,
        frame_ms,
    } = want;
    let wait = Duration::from_millis(wait_ms.into()).min(limits::MAX_WAIT);
    let granted = tokio::select! {
        granted = app.dispatch.lease(&worker_id, wait, frame_ms) => granted.map_err(unknown_worker)?,
        // An empty answer would be asked again at once.
        () = app.stop.cancelled() => return Err(Problem::overloaded("the service is stopping")),
    };
    let Some(granted) = granted else {
        return Ok(ProtoBody(LeaseResponse { lease: None }));
    };
    let Some(job) = app.catalogue.job(&granted.lease().job_id).await? else {
        // Deleted between its submission and its offer.
        app.dispatch.cancel(&granted.lease().job_id);
        return Ok(ProtoBody(LeaseResponse { lease: None }));
    };
    let lease = described(granted.hand_over(), job.spec);
    faults::point("lease.granted");
    Ok(ProtoBody(LeaseResponse {
        lease: Some(lease.into()),
    }))
}

fn described(grant: Grant, spec_json: String) -> Lease {
    let Grant {
        token,
        job_id,
        frames,
    } = grant;
    Lease {
        token,
        job_id,
        spec_json,
        frames,
        term_ms: TERM_MS,
    }
}
