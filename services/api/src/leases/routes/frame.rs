//! `POST /v1/worker/artifacts`, `commit` and `fail`: what the holder of a lease reports of a frame.

use catalogue::InsertImage;
use proto::wire::{Claim, CommitRequest, CommitResponse, FailRequest, PutArtifactsRequest};
use spec::{ArtifactEntry, FrameRecord};
use store::Blob;

use crate::http::{Problem, Protobuf, Slug, State, Topic};
use crate::leases::Leases;
use crate::processes::compute::to_the_end;
use crate::telemetry;

/// Stores the artifacts of a frame durably before returning. Only the holder of the lease may.
pub(crate) async fn artifacts(
    State(leases): Topic<Leases>,
    Protobuf(request): Protobuf<PutArtifactsRequest>,
) -> Result<(), Problem> {
    let claim = request.claim.unwrap_or_default();
    let current = leases.dispatch.table(|table, _| table.check(&claim));
    current.map_err(|_| stale_lease(&claim))?;
    leases.bytes.space.room().await?;
    let blobs = request.artifacts.into_iter().map(|file| Blob {
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
    Ok(())
}

/// Makes a frame's image visible. Repeats are harmless: the first one wins and the others change nothing.
pub(crate) async fn commit(
    State(leases): Topic<Leases>,
    Protobuf(request): Protobuf<CommitRequest>,
) -> Result<Protobuf<CommitResponse>, Problem> {
    let record = request.record()?;
    let claim = request.claim.unwrap_or_default();
    let begun = leases
        .dispatch
        .table(|table, now| table.begin_commit(&claim, now));
    begun.map_err(|_| stale_lease(&claim))?;
    faults::point("commit.begun");
    // From here on the frame is pinned: the task unpins it even if the worker hangs up.
    let stored = to_the_end(async move { leases.commit(&claim, &record).await }).await?;
    let already_there = stored == InsertImage::AlreadyThere;
    Ok(Protobuf(CommitResponse { already_there }))
}

/// Reports a failed attempt: the frame is tried again after a pause, or given up.
pub(crate) async fn fail(
    State(leases): Topic<Leases>,
    Protobuf(request): Protobuf<FailRequest>,
) -> Result<(), Problem> {
    let claim = request.claim.unwrap_or_default();
    let event = leases
        .dispatch
        .table(|table, now| table.fail(&claim, request.retryable, &request.error, now));
    let event = event.map_err(|_| stale_lease(&claim))?;
    leases.record_strikes(vec![event]).await;
    Ok(())
}

impl Leases {
    /// Stores the image of a pinned frame and unpins it.
    async fn commit(&self, claim: &Claim, record: &FrameRecord) -> Result<InsertImage, Problem> {
        let inserted = self.insert(claim, record).await;
        faults::point("commit.inserted");
        match inserted {
            Err(_) => self.dispatch.free(|table, _| table.abort_commit(claim)),
            Ok(_) => self.dispatch.table(|table, _| table.finish_commit(claim)),
        }
        if matches!(inserted, Ok(InsertImage::Inserted)) {
            telemetry::committed(record);
            self.costs.learn(record);
        }
        self.changes.notify(&claim.job_id);
        inserted
    }

    async fn insert(&self, claim: &Claim, record: &FrameRecord) -> Result<InsertImage, Problem> {
        self.bytes.space.room().await?;
        let _turn = self.bytes.naming.beside_others().await;
        for ArtifactEntry { kind, digest, .. } in &record.artifacts {
            if !self.bytes.store.contains(digest).await? {
                let detail = format!("artifact `{kind}` with digest {digest} was not stored");
                return Err(Problem::new(Slug::InvalidBody, detail));
            }
        }
        let now_ms = self.clock.wall().0;
        let inserted = self.catalogue.insert_image(&claim.job_id, record, now_ms).await?;
        let digests = record.artifacts.iter().map(|artifact| artifact.digest.as_str());
        self.bytes.naming.named(digests);
        Ok(inserted)
    }
}

fn stale_lease(claim: &Claim) -> Problem {
    let Claim {
        token,
        job_id,
        frame,
        attempt,
    } = claim;
    let detail = format!("token {token} does not hold attempt {attempt} at frame {frame} of {job_id}");
    Problem::new(Slug::StaleLease, detail).with("token", *token)
}
