//! The columnar replica, from which images are counted.

use api::Data;
use catalogue::REPLICA_ROWS;

use super::Findings;

/// Compares the replica with the catalogue. With `rebuild`, writes it again; with `repair`, writes its faulty files again.
pub(super) async fn verify(
    data: &Data,
    repair: bool,
    rebuild: bool,
    findings: &mut Findings,
) -> anyhow::Result<()> {
    findings.mirror = data.catalogue.check_replica().await?;
    if rebuild {
        findings.mirror_written = data.catalogue.rebuild_replica().await?;
    }
    while repair && data.catalogue.replicate_some(REPLICA_ROWS).await? {
        findings.mirror_written += 1;
    }
    Ok(())
}
