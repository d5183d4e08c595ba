//! Getting the space of deleted jobs back, a little at a time beside everything else.

use std::time::Duration;

use tokio_util::sync::CancellationToken;

use crate::app::{App, Shared};
use crate::http::problem::{Problem, Slug};

/// Digests that are deleted at a time: whoever stores an image waits for that long, some tens of milliseconds.
const BATCH: u32 = 256;
/// What could not be deleted, since somebody was about to name it or the disk was full, is tried again after this time.
const AGAIN: Duration = Duration::from_secs(60);

/// Reclaims whenever something was deleted, and once at the start for what an earlier life of the service left.
pub(crate) async fn run(app: Shared, end: CancellationToken) {
    loop {
        let left = match reclaim(&app, &end).await {
            Ok(left) => left,
            Err(problem) if problem.is(Slug::StorageFull) && app.space.give_reserve() => continue,
            Err(problem) => {
                tracing::error!(%problem, "the space of deleted jobs does not come back yet");
                true
            }
        };
        app.space.take_reserve_back().await;
        let pause = if left { AGAIN } else { Duration::MAX };
        tokio::select! {
            () = end.cancelled() => return,
            () = app.reclaim.notified() => {}
            () = tokio::time::sleep(pause) => {}
        }
    }
}

/// Answers whether something is left.
async fn reclaim(app: &App, end: &CancellationToken) -> Result<bool, Problem> {
    let _alone = app.upkeep.lock().await;
    while !end.is_cancelled() && app.catalogue.sweep().await? {}
    let mut bytes = 0;
    let left = loop {
        if end.is_cancelled() {
            break true;
        }
        match delete_some(app).await? {
            Step::Deleted(more) => bytes += more,
            Step::Waiting => break true,
            Step::Finished => break false,
        }
    };
    if bytes > 0 {
        let freed = app.store.compact().await?;
        tracing::info!(
            bytes,
            packs = freed.packs,
            disk = freed.bytes_freed,
            "deleted artifacts are gone"
        );
    }
    Ok(left)
}

enum Step {
    /// Bytes of what is gone.
    Deleted(u64),
    /// What is left is about to be named again.
    Waiting,
    Finished,
}

async fn delete_some(app: &App) -> Result<Step, Problem> {
    // From here to the end no row may be stored that names one of the orphans.
    let _nobody = app.naming.alone().await;
    let orphans = app.catalogue.orphans(BATCH).await?;
    if orphans.is_empty() {
        return Ok(Step::Finished);
    }
    let gone: Vec<String> = orphans
        .into_iter()
        .filter(|digest| !app.naming.is_fresh(digest))
        .collect();
    if gone.is_empty() {
        return Ok(Step::Waiting);
    }
    let bytes = app.store.delete(&gone).await?;
    app.catalogue.forget_orphans(gone).await?;
    Ok(Step::Deleted(bytes))
}
