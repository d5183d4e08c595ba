//! Waiting for a job to change.

use std::time::Duration;

use catalogue::JobRow;
use tokio::time::{Instant, timeout_at};

use crate::app::App;
use crate::http::problem::Problem;
use crate::jobs::control::known;

/// What to wait for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Until {
    /// The job has ended.
    Ended,
    /// Its version is larger than this, or it has ended.
    After(u64),
}

/// The job as it is when what is waited for has come, when the time is over, or when the service stops.
pub(crate) async fn wait_for_job(
    app: &App,
    id: &str,
    limit: Duration,
    until: Until,
) -> Result<JobRow, Problem> {
    let deadline = Instant::now() + limit;
    let bell = app.watch.of(id);
    loop {
        let mut change = std::pin::pin!(bell.notified());
        change.as_mut().enable();
        let row = known(app, id).await?;
        let come = match until {
            Until::Ended => false,
            Until::After(version) => row.version > version,
        };
        if come || row.state.has_ended() || app.stop.is_cancelled() {
            return Ok(row);
        }
        let woken = tokio::select! {
            woken = timeout_at(deadline, change) => woken.is_ok(),
            () = app.stop.cancelled() => true,
        };
        if !woken {
            return Ok(row);
        }
    }
}
