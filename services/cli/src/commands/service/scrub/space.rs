//! Unreferenced space and damaged packs.

use std::path::Path;

use api::{Data, clear_unfinished};

use super::{Findings, Unnamed};

/// Digests of one query.
const BATCH: usize = 1000;

/// Reports damaged packs, unreferenced blobs and unfinished backups; `free` rewrites and removes them.
pub(super) async fn look(
    data: &Data,
    folder: &Path,
    free: bool,
    findings: &mut Findings,
) -> anyhow::Result<()> {
    let mut unnamed = Vec::new();
    for some in data.store.digests().chunks(BATCH) {
        let digests: Vec<String> = some.iter().map(hex::encode).collect();
        unnamed.extend(data.catalogue.unnamed(&digests).await?);
    }
    findings.unnamed = Unnamed {
        blobs: unnamed.len() as u64,
        freed: 0,
    };
    if free {
        data.store.delete(&unnamed).await?;
        findings.unnamed.freed = data.store.compact().await?.bytes_freed + clear_unfinished(folder)?;
    }
    for (pack, finding) in data.store.check().await? {
        let text = format!("pack {pack}: {finding}");
        // A second finding about a pack that is gone is not one any more.
        let is_gone = free && data.store.rewrite(pack).await?;
        if !is_gone && !findings.packs.contains(&text) {
            findings.packs.push(text);
        }
    }
    if free {
        findings.packs = data
            .store
            .check()
            .await?
            .into_iter()
            .map(|(pack, finding)| format!("pack {pack}: {finding}"))
            .collect();
    }
    Ok(())
}
