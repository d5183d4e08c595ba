//! `POST /v1/worker/commit`.

use std::sync::Arc;

use axum::extract::State;
use catalogue::InsertImage;
use proto::message::{Claim, Commit};
use proto::wire::{CommitRequest, CommitResponse};
use spec::FrameRecord;

use super::stale_lease;
use crate::app::{App, Shared};
use crate::http::extract::{Checked, ProtoBody};
use crate::http::problem::{Problem, Slug};
use crate::telemetry;

/// Makes a frame's image visible. Repeats are harmless: the first one wins and the others change nothing.
pub(crate) async fn commit(
    State(app): State<Shared>,
    Checked(Commit { claim, record }, _): Checked<CommitRequest, Commit>,
) -> Result<ProtoBody<CommitResponse>, Problem> {
    app.dispatch
        .begin_commit(&claim)
        .map_err(|_| stale_lease(&claim))?;
    faults::point("commit.begun");
    // From here on the frame is held: the task ends the hold even if the worker hangs up.
    let app = Arc::clone(&app);
    let task = tokio::spawn(async move { held(&app, &claim, &record).await });
    let already_there = task.await.map_err(|error| Problem::internal(&error))??;
    Ok(ProtoBody(CommitResponse { already_there }))
}

async fn held(app: &App, claim: &Claim, record: &FrameRecord) -> Result<bool, Problem> {
    let inserted = insert(app, claim, record).await;
    faults::point("commit.inserted");
    match inserted {
        Ok(InsertImage::AlreadyThere) => app.dispatch.finish_commit(claim),
        Ok(InsertImage::Inserted) => {
            app.dispatch.finish_commit(claim);
            telemetry::committed(record);
            app.experience.learn(record);
        }
        Err(_) => app.dispatch.abort_commit(claim),
    }
    app.watch.wake(&claim.job_id);
    inserted.map(|inserted| matches!(inserted, InsertImage::AlreadyThere))
}

async fn insert(app: &App, claim: &Claim, record: &FrameRecord) -> Result<InsertImage, Problem> {
    app.space.room().await?;
    let _turn = app.naming.beside_others().await;
    for artifact in &record.artifacts {
        if !app.store.contains(&artifact.digest).await? {
            let detail = format!(
                "artifact `{}` with digest {} was not stored",
                artifact.kind, artifact.digest
            );
            return Err(Problem::new(Slug::InvalidBody, detail));
        }
    }
    let inserted = app
        .catalogue
        .insert_image(&claim.job_id, record, app.clock.unix_ms())
        .await?;
    app.naming
        .named(record.artifacts.iter().map(|artifact| artifact.digest.as_str()));
    Ok(inserted)
}
