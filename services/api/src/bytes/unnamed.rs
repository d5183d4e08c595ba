//! Bytes that no row names: a worker stored them, and its commit never came.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use tokio_util::sync::CancellationToken;

use super::Bytes;
use crate::http::problem::Problem;

/// What is without a name twice in a row, so far apart, goes. No lease is as long.
const INTERVAL: Duration = Duration::from_secs(3600);
/// Digests of one question.
const BATCH: usize = 1000;

/// Looks for such bytes at the start, when no lease is out that could still name them, and then again and again.
pub(crate) async fn run(bytes: Arc<Bytes>, end: CancellationToken) {
    let mut before: Option<HashSet<[u8; 32]>> = None;
    loop {
        match sweep(&bytes, before.as_ref(), &end).await {
            Ok(left) => before = Some(left),
            Err(problem) => tracing::error!(%problem, "bytes without a name stay for now"),
        }
        tokio::select! {
            () = end.cancelled() => return,
            () = tokio::time::sleep(INTERVAL) => {}
        }
    }
}

/// Hands what had no name `before`, either, over to be reclaimed; `None`: whatever has none. Returns what has none now.
async fn sweep(
    bytes: &Bytes,
    before: Option<&HashSet<[u8; 32]>>,
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
            match before {
                Some(before) if !before.contains(digest) => drop(left.insert(*digest)),
                _ => gone.push(text),
            }
        }
        orphans += gone.len();
        if !gone.is_empty() {
            bytes.catalogue.add_orphans(gone).await?;
        }
    }
    if orphans > 0 {
        tracing::info!(orphans, "bytes that no row names are reclaimed");
        bytes.reclaim.notify_one();
    }
    Ok(left)
}
