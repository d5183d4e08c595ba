//! Reclaims the space of deleted jobs in the background, in small batches.

use std::sync::Arc;
use std::time::Duration;

use tokio_util::sync::CancellationToken;

use super::Bytes;
use crate::http::problem::{Problem, Slug};

/// Digests of one batch. A commit waits for at most one, some tens of milliseconds.
const BATCH: u32 = 256;
/// Pause before retrying bytes that a pending commit protects or that a full disk kept.
const AGAIN: Duration = Duration::from_secs(60);

/// Reclaims after each deletion, and once at startup for deletions of an earlier run.
pub(crate) async fn run(bytes: Arc<Bytes>, end: CancellationToken) {
    loop {
        let left = match reclaim(&bytes, &end).await {
            Ok(left) => left,
            Err(problem) if problem.is(Slug::StorageFull) && bytes.space.give_reserve() => continue,
            Err(problem) => {
                tracing::error!(%problem, "cannot reclaim the space of deleted jobs yet");
                true
            }
        };
        bytes.space.take_reserve_back().await;
        let pause = if left { AGAIN } else { Duration::MAX };
        tokio::select! {
            () = end.cancelled() => return,
            () = bytes.reclaim.notified() => {}
            () = tokio::time::sleep(pause) => {}
        }
    }
}

/// Returns whether anything remains.
async fn reclaim(bytes: &Bytes, end: &CancellationToken) -> Result<bool, Problem> {
    let _alone = bytes.upkeep.lock().await;
    while !end.is_cancelled() && bytes.catalogue.sweep().await? {}
    let mut deleted = 0;
    let left = loop {
        if end.is_cancelled() {
            break true;
        }
        match delete_some(bytes).await? {
            Step::Deleted(more) => deleted += more,
            Step::Waiting => break true,
            Step::Finished => break false,
        }
    };
    if deleted > 0 {
        let freed = bytes.store.compact().await?;
        tracing::info!(
            bytes = deleted,
            packs = freed.packs,
            disk = freed.bytes_freed,
            "reclaimed deleted artifacts"
        );
    }
    Ok(left)
}

enum Step {
    /// Bytes deleted.
    Deleted(u64),
    /// Pending commits protect the remaining orphans.
    Waiting,
    Finished,
}

async fn delete_some(bytes: &Bytes) -> Result<Step, Problem> {
    // No row that references an orphan may be stored until the end of this function.
    let _alone = bytes.naming.alone().await;
    let orphans = bytes.catalogue.orphans(BATCH).await?;
    if orphans.is_empty() {
        return Ok(Step::Finished);
    }
    let gone: Vec<String> = orphans
        .into_iter()
        .filter(|digest| !bytes.naming.is_fresh(digest))
        .collect();
    if gone.is_empty() {
        return Ok(Step::Waiting);
    }
    let deleted = bytes.store.delete(&gone).await?;
    bytes.catalogue.forget_orphans(gone).await?;
    Ok(Step::Deleted(deleted))
}
