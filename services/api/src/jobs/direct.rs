//! Direct renders: the priority of their jobs ends with the request.

use std::sync::Arc;

use spec::Job;
use tokio::runtime::Handle;

use super::Jobs;
use super::submit::{Followed, Submission};
use crate::http::problem::Problem;
use crate::limits;
use crate::processes::compute::to_the_end;

/// Consequence of a client that leaves before its frame is rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OnLeave {
    /// The job continues without priority: the client can repeat the request with its key.
    Continue,
    /// The job is cancelled.
    Cancel,
    /// The job is deleted with its image.
    Delete,
}

/// The request of a direct render. If it is dropped before [`RenderRequest::end`], the client has left.
pub(super) struct RenderRequest {
    jobs: Arc<Jobs>,
    id: String,
    on_leave: OnLeave,
    has_ended: bool,
}

impl RenderRequest {
    fn new(jobs: Arc<Jobs>, id: String, on_leave: OnLeave) -> Self {
        Self {
            jobs,
            id,
            on_leave,
            has_ended: false,
        }
    }

    /// The request has its response. A job that has not ended continues as an ordinary one.
    pub(super) fn end(mut self) {
        self.has_ended = true;
        self.jobs.end_priority(&self.id);
    }
}

impl Drop for RenderRequest {
    fn drop(&mut self) {
        if self.has_ended {
            return;
        }
        self.jobs.end_priority(&self.id);
        let Ok(runtime) = Handle::try_current() else {
            return;
        };
        let (jobs, id, on_leave) = (Arc::clone(&self.jobs), self.id.clone(), self.on_leave);
        runtime.spawn(async move {
            let ended = match on_leave {
                OnLeave::Continue => Ok(()),
                OnLeave::Cancel => jobs.cancel(id.clone()).await.map(drop),
                OnLeave::Delete => jobs.delete(id.clone()).await.map(drop),
            };
            if let Err(problem) = ended {
                tracing::warn!(job = id, %problem, "cannot end the job of a client that left");
            }
        });
    }
}

impl Jobs {
    /// Stores a direct render and offers it before the caller's other jobs.
    pub(super) async fn submit_direct(
        self: &Arc<Self>,
        job: Job,
        submission: Submission,
        on_leave: OnLeave,
    ) -> Result<(Followed, RenderRequest), Problem> {
        self.check_runtime(&job)?;
        let price = self.price(&job).await?;
        self.bytes.space.room().await?;
        let jobs = Arc::clone(self);
        // The request exists as soon as the job does, even if the client has left by then.
        to_the_end(async move {
            let submitted = jobs.store(&job, submission, price).await?;
            let request = RenderRequest::new(Arc::clone(&jobs), submitted.job.row.id.clone(), on_leave);
            Ok((submitted.job, request))
        })
        .await
    }

    fn end_priority(&self, id: &str) {
        let dispatch = &self.leases.dispatch;
        dispatch.table(|table, _| table.set_priority(id, limits::JOB_PRIORITY));
    }
}
