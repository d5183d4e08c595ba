//! What to do with a job that waits for a kind of machine: finish it on others, or start again.

use std::sync::Arc;
use std::time::Duration;

use catalogue::JobRow;
use tokio_util::sync::CancellationToken;

use super::Jobs;
use crate::http::problem::Problem;
use crate::leases::Leases;

/// Interval of looking whether images are still being written.
const LOOK: Duration = Duration::from_millis(5);
/// Interval of looking for interrupted restarts.
const PAUSE: Duration = Duration::from_secs(30);

impl Jobs {
    /// Lets workers of any version and kind of machine render the remaining frames.
    pub(crate) async fn finish_elsewhere(self: &Arc<Self>, id: String) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            jobs.check_version(&id).await?;
            let row = jobs.catalogue.mix_machines(&id, true).await?;
            jobs.leases.dispatch.free(|table, _| table.mix(&id));
            jobs.notify(&id, "open to workers of any kind");
            Ok(row)
        })
        .await
    }

    /// Removes all images of a job and renders its frames from the beginning.
    pub(crate) async fn start_again(self: &Arc<Self>, id: String) -> Result<JobRow, Problem> {
        self.in_turn(|jobs| async move {
            jobs.check_version(&id).await?;
            jobs.catalogue.begin_restart(&id).await?;
            jobs.restart(&id).await
        })
        .await
    }

    /// Continues the restarts that a kill or an error interrupted.
    async fn continue_restarts(self: &Arc<Self>) -> Result<(), Problem> {
        for id in self.catalogue.restarting_jobs().await? {
            self.in_turn(|jobs| async move {
                // It may have ended or been deleted before its turn.
                match jobs.catalogue.restarting_jobs().await?.contains(&id) {
                    true => jobs.restart(&id).await.map(drop),
                    false => Ok(()),
                }
            })
            .await?;
        }
        Ok(())
    }

    /// Withdraws a job from workers, removes its images and offers its frames again.
    async fn restart(&self, id: &str) -> Result<JobRow, Problem> {
        let Leases { dispatch, proofs, .. } = &*self.leases;
        dispatch.cancel(id);
        proofs.forget_job(id);
        // Images that are being written are removed with the others.
        while dispatch.table(|table, _| table.is_being_written(id)) {
            tokio::time::sleep(LOOK).await;
        }
        let row = loop {
            if let Some(row) = self.catalogue.continue_restart(id).await? {
                break row;
            }
        };
        if !row.state.has_ended() {
            self.offer_again(&row).await?;
        }
        self.bytes.reclaim.notify_one();
        self.notify(id, "started again");
        Ok(row)
    }
}

/// Continues interrupted restarts, first those of an earlier run of the service.
pub(crate) async fn run(jobs: Arc<Jobs>, end: CancellationToken) {
    let work = async {
        loop {
            if let Err(problem) = jobs.continue_restarts().await {
                tracing::warn!(%problem, "a job cannot start again now; it is repeated");
            }
            tokio::time::sleep(PAUSE).await;
        }
    };
    end.run_until_cancelled(work).await;
}
