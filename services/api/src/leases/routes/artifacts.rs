//! `POST /v1/worker/artifacts`.

use axum::extract::State;
use proto::message::PutArtifacts;
use proto::wire::{PutArtifactsRequest, PutArtifactsResponse};
use store::Blob;

use super::stale_lease;
use crate::app::Shared;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::Problem;

/// Stores the files of a frame; they are durable when this answers. Only the holder of the lease can.
pub(crate) async fn artifacts(
    State(app): State<Shared>,
    Checked(PutArtifacts { claim, artifacts }, _): Checked<PutArtifactsRequest, PutArtifacts>,
) -> Result<ProtoBody<PutArtifactsResponse>, Problem> {
    app.dispatch.check(&claim).map_err(|_| stale_lease(&claim))?;
    app.space.room().await?;
    let blobs = artifacts.into_iter().map(|file| Blob {
        digest: file.digest,
        bytes: file.data,
    });
    let blobs: Vec<Blob> = blobs.collect();
    faults::point("artifacts.received");
    app.naming
        .announce(blobs.iter().map(|blob| blob.digest.clone()))
        .await;
    app.store.put_all(blobs).await?;
    faults::point("artifacts.stored");
    Ok(ProtoBody(PutArtifactsResponse {}))
}
