//! Deletes bytes without a row: a worker stored them and never committed.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use tokio_util::sync::CancellationToken;

use super::Bytes;
use crate::http::problem::Problem;

/// Digests of one query.
const BATCH: usize = 1000;

/// Searches periodically. Bytes without a row in two consecutive searches, `interval` apart, are deleted.
pub(crate) async fn run(bytes: Arc<Bytes>, interval: Duration, end: CancellationToken) {
    let mut before = HashSet::new();
    loop {
        match sweep(&bytes, &before, &end).await {
            Ok(left) => before = left,
            Err(problem) => tracing::error!(%problem, "cannot reclaim unreferenced bytes yet"),
        }
        tokio::select! {
            () = end.cancelled() => return,
            () = tokio::time::sleep(interval) => {}
        }
    }
}

/// Queues bytes that were also unreferenced `before` for reclaiming. Returns the newly unreferenced ones.
async fn sweep(
    bytes: &Bytes,
    before: &HashSet<[u8; 32]>,
    end: &CancellationToken,
) -> Result<HashSet<[u8; 32]>, Problem> {
    let mut left = HashSet::new();
    let mut orphans = 0;
    for some in bytes.store.digests().chunks(BATCH) {
        if end.is_cancelled() {
            break;
        }
        let asked: Vec<String> = some.iter().map(hex::encode).collect();
        let unnamed = bytes.catalogue.unnamed(&asked).await?;
        let mut gone = Vec::new();
        for (digest, text) in some.iter().zip(asked) {
            if !unnamed.contains(&text) || bytes.naming.is_fresh(&text) {
                continue;
            }
            if before.contains(digest) {
                gone.push(text);
            } else {
                left.insert(*digest);
            }
        }
        orphans += gone.len();
        if !gone.is_empty() {
            bytes.catalogue.add_orphans(gone).await?;
        }
    }
    if orphans > 0 {
        tracing::info!(orphans, "reclaiming unreferenced bytes");
        bytes.reclaim.notify_one();
    }
    Ok(left)
}
