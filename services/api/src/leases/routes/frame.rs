//! Reports of the holder of a lease on a frame.

use std::sync::Arc;

use catalogue::{Delivery, DueCheck, InsertImage};
use imaging::codec::read_sides;
use spec::{ArtifactEntry, Frame, FrameRecord};
use store::Blob;
use wire::limits::shorten;
use wire::messages::{Artifact, Claim, CommitRequest, CommitResponse, FailRequest, PutArtifactsRequest};

use crate::http::{Problem, Protobuf, Slug, State, Topic};
use crate::leases::Leases;
use crate::leases::checks::{Evidence, check_file};
use crate::leases::pending::{PendingArtifact, PendingFrame};
use crate::leases::table::Toolchain;
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
    leases.room(&claim).await?;
    let frame = Arc::new(leases.frame(&claim).await?);
    let faults = request.artifacts.iter().flat_map(|file| check_file(&frame, file));
    let faults: Vec<String> = faults.collect();
    if !faults.is_empty() {
        return Err(leases.refuse(&claim, &faults).await);
    }
    let pending = request.artifacts.iter().map(to_pending).collect();
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
    leases.pending.add(&claim, frame, pending);
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
    let current = leases.dispatch.table(|table, _| table.check(&claim));
    current.map_err(|_| stale_lease(&claim))?;
    let (worker, frame) = leases.examine(&claim, &record, &request.record_json).await?;
    let toolchain = Toolchain::from_provenance(&record.provenance);
    let begun = leases.dispatch.begin_commit(&claim, &toolchain);
    begun.map_err(|_| stale_lease(&claim))?;
    faults::point("commit.begun");
    // The frame is pinned now: the task unpins it even if the worker disconnects.
    let stored = to_the_end(async move { leases.commit(&claim, &record, &worker, &frame).await }).await?;
    let already_there = stored == InsertImage::AlreadyThere;
    Ok(Protobuf(CommitResponse { already_there }))
}

/// Reports a failed attempt: the frame is tried again after a pause, or quarantined.
pub(crate) async fn fail(
    State(leases): Topic<Leases>,
    Protobuf(request): Protobuf<FailRequest>,
) -> Result<(), Problem> {
    let claim = request.claim.unwrap_or_default();
    let event = leases
        .dispatch
        .table(|table, now| table.fail(&claim, request.retryable, &request.error, now));
    let event = event.map_err(|_| stale_lease(&claim))?;
    leases.pending.remove(&claim);
    leases.record_strikes(vec![event]).await;
    Ok(())
}

fn to_pending(file: &Artifact) -> PendingArtifact {
    PendingArtifact {
        entry: ArtifactEntry {
            kind: file.kind.clone(),
            digest: file.digest.clone(),
            bytes: file.data.len() as u64,
            media_type: file.media_type.clone(),
        },
        sides: read_sides(&file.data),
    }
}

impl Leases {
    /// Fails on a full disk without blaming the worker.
    async fn room(&self, claim: &Claim) -> Result<(), Problem> {
        let room = self.bytes.space.room().await;
        if room.is_err() {
            self.dispatch.table(|table, now| table.excuse(claim.token, now));
        }
        room
    }

    /// The frame of a claim as its description resolves it.
    async fn frame(&self, claim: &Claim) -> Result<Frame, Problem> {
        let job = self.descriptions.get(&self.catalogue, &claim.job_id).await?;
        job.resolve(claim.frame)
            .map_err(|error| Problem::internal(&error))
    }

    /// Compares a record with the known facts of its frame; returns the worker and the frame.
    async fn examine(
        &self,
        claim: &Claim,
        record: &FrameRecord,
        text: &[u8],
    ) -> Result<(String, Arc<Frame>), Problem> {
        let worker = self.dispatch.holder(claim.token);
        let (id, worker) = worker.ok_or_else(|| stale_lease(claim))?;
        let known = match self.pending.get(claim) {
            Some(known) => known,
            None => PendingFrame {
                frame: Arc::new(self.frame(claim).await?),
                files: vec![],
            },
        };
        let received = match self.dispatch.is_own(&id) {
            true => None,
            false => serde_json::from_slice(text).ok(),
        };
        let evidence = Evidence {
            frame: &known.frame,
            pending: &known.files,
            worker: &worker,
            record,
            received: received.as_ref(),
        };
        let faults = evidence.faults();
        if faults.is_empty() {
            return Ok((id, known.frame));
        }
        Err(self.refuse(claim, &faults).await)
    }

    /// Rejects a worker's report on a frame: the frame is offered again, and the worker is dismissed after a few
    /// rejections.
    async fn refuse(&self, claim: &Claim, faults: &[String]) -> Problem {
        self.pending.remove(claim);
        let detail = shorten(&faults.join("; "));
        let events = self.dispatch.refuse(claim, &detail);
        self.record_strikes(events).await;
        Problem::new(Slug::InvalidBody, detail)
    }

    /// Stores the image of a pinned frame and unpins it.
    async fn commit(
        &self,
        claim: &Claim,
        record: &FrameRecord,
        worker: &str,
        frame: &Frame,
    ) -> Result<InsertImage, Problem> {
        let is_own = self.dispatch.is_own(worker);
        let now_ms = self.clock.wall().0;
        let delivery = match is_own {
            true => None,
            false => self
                .proofs
                .begin_delivery(worker, &claim.job_id, claim.frame, now_ms),
        };
        let check = delivery.as_ref().filter(|delivery| delivery.is_due);
        let check = check.map(|delivery| DueCheck {
            job: claim.job_id.clone(),
            frame: claim.frame,
            worker: delivery.worker.clone(),
        });
        let inserted = self.insert(claim, record, delivery).await;
        faults::point("commit.inserted");
        match inserted {
            Err(_) => self.dispatch.free(|table, _| table.abort_commit(claim)),
            Ok(_) => self.dispatch.table(|table, _| table.finish_commit(claim)),
        }
        if matches!(inserted, Ok(InsertImage::Inserted)) {
            telemetry::committed(record);
            self.costs.learn(frame, record);
            match is_own {
                true => self.probes.record_commit(worker, &claim.job_id, claim.frame),
                false => self.proofs.push(check),
            }
            self.end_if_complete(&claim.job_id);
        }
        self.changes.notify(&claim.job_id);
        inserted
    }

    async fn insert(
        &self,
        claim: &Claim,
        record: &FrameRecord,
        delivery: Option<Delivery>,
    ) -> Result<InsertImage, Problem> {
        self.room(claim).await?;
        let _turn = self.bytes.naming.beside_others().await;
        for ArtifactEntry { kind, digest, .. } in &record.artifacts {
            if !self.bytes.store.contains(digest).await? {
                let detail = format!("artifact `{kind}` with digest {digest} is no longer stored");
                return Err(Problem::new(Slug::InvalidBody, detail));
            }
        }
        let now_ms = self.clock.wall().0;
        let inserted = self
            .catalogue
            .insert_delivered(&claim.job_id, record, now_ms, delivery)
            .await?;
        let digests = record.artifacts.iter().map(|artifact| artifact.digest.as_str());
        self.bytes.naming.named(digests);
        self.pending.remove(claim);
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
    Problem::new(Slug::StaleLease, detail).with_member("token", *token)
}
