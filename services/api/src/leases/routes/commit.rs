//! `POST /v1/worker/commit`.

use std::sync::Arc;

use axum::extract::State;
use catalogue::InsertImage;
use proto::message::{Claim, Commit};
use proto::wire::{CommitRequest, CommitResponse};
use spec::{ArtifactEntry, FrameRecord};

use super::stale_lease;
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::{Problem, Slug};
use crate::leases::Leases;
use crate::processes::compute::to_the_end;
use crate::telemetry;

/// Makes a frame's image visible. Repeats are harmless: the first one wins and the others change nothing.
pub(crate) async fn commit(
    State(leases): State<Arc<Leases>>,
    Checked(Commit { claim, record }, _): Checked<CommitRequest, Commit>,
) -> Result<ProtoBody<CommitResponse>, Problem> {
    let begun = leases
        .dispatch
        .table(|table, now| table.begin_commit(&claim, now));
    begun.map_err(|_| stale_lease(&claim))?;
    faults::point("commit.begun");
    // From here on the frame is pinned: the task unpins it even if the worker hangs up.
    let stored = to_the_end(async move { leases.commit(&claim, &record).await }).await?;
    let already_there = stored == InsertImage::AlreadyThere;
    Ok(ProtoBody(CommitResponse { already_there }))
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
