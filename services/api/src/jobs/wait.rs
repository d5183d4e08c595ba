//! Waiting for a job to change.

use std::time::Duration;

use catalogue::JobRow;
use tokio::time::{Instant, timeout_at};

use super::Jobs;
use super::submit::Followed;
use crate::http::problem::Problem;

/// Condition of a wait.
#[derive(Debug, Clone, Copy)]
pub(super) enum Until {
    /// The job has ended.
    Ended,
    /// Its version is larger than this, or it has ended.
    After(u64),
}

impl Until {
    fn has_come(self, row: &JobRow) -> bool {
        let changed = matches!(self, Self::After(version) if row.version > version);
        changed || row.state.has_ended()
    }
}

impl Jobs {
    /// Returns the job once the condition holds, the time is over, or the service stops.
    pub(super) async fn wait(&self, id: &str, limit: Duration, until: Until) -> Result<JobRow, Problem> {
        let changes = self.leases.changes.subscribe(id);
        let row = self.get(id).await?;
        self.wait_on(Followed { row, changes }, limit, until).await
    }

    /// Waits on a job with a known state.
    pub(super) async fn wait_on(
        &self,
        job: Followed,
        limit: Duration,
        until: Until,
    ) -> Result<JobRow, Problem> {
        let deadline = Instant::now() + limit;
        let Followed { mut row, mut changes } = job;
        while !until.has_come(&row) && !self.stop.is_cancelled() {
            tokio::select! {
                woken = timeout_at(deadline, changes.changed()) => if woken.is_err() {
                    break;
                },
                () = self.stop.cancelled() => {}
            }
            row = self.get(&row.id).await?;
        }
        Ok(row)
    }
}
