//! The mirror, from which images are counted.

use api::Data;
use catalogue::REPLICA_ROWS;

use super::Findings;

/// Compares the mirror with the catalogue; `repair` writes what was found, and `anew` all of it.
pub(super) async fn look(
    data: &Data,
    repair: bool,
    anew: bool,
    findings: &mut Findings,
) -> anyhow::Result<()> {
    findings.mirror = data.catalogue.check_replica().await?;
    if anew {
        findings.mirror_written = data.catalogue.rebuild_replica().await?;
    }
    while repair && data.catalogue.replicate_some(REPLICA_ROWS).await? {
        findings.mirror_written += 1;
    }
    Ok(())
}
