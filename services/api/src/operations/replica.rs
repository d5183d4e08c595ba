//! Writes the columnar replica of the catalogue while the service runs.

use std::sync::Arc;
use std::time::Duration;

use catalogue::{Catalogue, REPLICA_ROWS};
use tokio_util::sync::CancellationToken;

/// Interval of checking for enough images for another file.
const INTERVAL: Duration = Duration::from_secs(1);
/// Pause after a failure, such as a full disk.
const PAUSE: Duration = Duration::from_secs(60);

/// Writes files as images arrive. Images without a file are counted from the tables.
pub(crate) async fn run(catalogue: Arc<Catalogue>, end: CancellationToken) {
    let mut wait = INTERVAL;
    while end.run_until_cancelled(tokio::time::sleep(wait)).await.is_some() {
        wait = match catalogue.replicate_some(REPLICA_ROWS).await {
            Ok(true) => Duration::ZERO,
            Ok(false) => INTERVAL,
            Err(error) => {
                tracing::warn!(%error, "cannot extend the columnar replica");
                PAUSE
            }
        };
    }
}
