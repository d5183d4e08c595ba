//! What to do with a job that waits for a kind of machine: finish it on others, or start again.

use std::sync::Arc;

use catalogue::{JobRow, JobState};

use super::Jobs;
use crate::http::problem::{Problem, Slug};

/// Images that one change removes: some 20 ms of the catalogue's writer.
const FRAMES_AT_ONCE: usize = 1000;

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
            // Refuses imported and sealed jobs before any lease is voided.
            let row = jobs.catalogue.reopen(&id, Vec::new()).await?.job;
            if row.state == JobState::Cancelled {
                let detail = format!("job {id} was cancelled and cannot start again; submit it again");
                return Err(Problem::new(Slug::JobState, detail));
            }
            jobs.leases.dispatch.cancel(&id);
            let open = jobs.catalogue.open_job(row).await?;
            let frames: Vec<u64> = open.done.into_iter().flatten().collect();
            for some in frames.chunks(FRAMES_AT_ONCE) {
                jobs.catalogue.reopen(&id, some.to_vec()).await?;
            }
            jobs.catalogue.retry_failed(&id).await?;
            let row = jobs.catalogue.mix_machines(&id, false).await?;
            jobs.offer_again(&row).await?;
            jobs.bytes.reclaim.notify_one();
            jobs.notify(&id, "started again");
            Ok(row)
        })
        .await
    }
}
