//! `POST /v1/worker/artifacts`.

use std::sync::Arc;

use axum::extract::State;
use proto::message::PutArtifacts;
use proto::wire::{PutArtifactsRequest, PutArtifactsResponse};
use store::Blob;

use super::stale_lease;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;
use crate::leases::Leases;

/// Stores the files of a frame; they are durable when this answers. Only the holder of the lease can.
pub(crate) async fn artifacts(
    State(leases): State<Arc<Leases>>,
    Checked(PutArtifacts { claim, artifacts }, _): Checked<PutArtifactsRequest, PutArtifacts>,
) -> Result<ProtoBody<PutArtifactsResponse>, Problem> {
    let current = leases.dispatch.table(|table, _| table.check(&claim));
    current.map_err(|_| stale_lease(&claim))?;
    leases.bytes.space.room().await?;
    let blobs = artifacts.into_iter().map(|file| Blob {
        digest: file.digest,
        bytes: file.data,
    });
    let blobs: Vec<Blob> = blobs.collect();
    faults::point("artifacts.received");
    leases
        .bytes
        .naming
        .announce(blobs.iter().map(|blob| blob.digest.clone()))
        .await;
    leases.bytes.store.put_all(blobs).await?;
    faults::point("artifacts.stored");
    Ok(ProtoBody(PutArtifactsResponse {}))
}
