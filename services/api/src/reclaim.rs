//! Getting the space of deleted jobs back, a little at a time beside everything else.

use catalogue::CatalogueError;
use tokio_util::sync::CancellationToken;

use crate::state::{App, Shared};

/// Takes the rows of deleted jobs away whenever something was deleted, and once at the start for what an earlier life
/// of the service left.
pub(crate) async fn run(app: Shared, end: CancellationToken) {
    loop {
        if let Err(error) = reclaim(&app, &end).await {
            tracing::error!(%error, "the space of deleted jobs does not come back; it is tried again after the next deletion");
        }
        if end.run_until_cancelled(app.reclaim.notified()).await.is_none() {
            return;
        }
    }
}

async fn reclaim(app: &App, end: &CancellationToken) -> Result<(), CatalogueError> {
    while !end.is_cancelled() && app.catalogue.sweep().await? {}
    Ok(())
}
