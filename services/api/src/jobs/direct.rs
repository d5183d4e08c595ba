//! Direct renders: the priority of their jobs ends with the request.

use std::sync::Arc;

use spec::Job;
use tokio::runtime::Handle;

use super::Jobs;
use super::submit::{Followed, Submission};
use crate::http::problem::Problem;
use crate::limits;
use crate::processes::compute::to_the_end;

/// Consequence of a request without a response that names its image or job: its client has left, or it failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unanswered {
    /// The job continues without priority: the client can repeat the request with its key.
    Continue,
    /// The job is cancelled.
    Cancel,
    /// The job is deleted with its image.
    Delete,
}

/// The request of a direct render. If it is dropped before [`RenderRequest::end`] and [`RenderRequest::fail`], the client
/// has left, or the service stops.
pub(super) struct RenderRequest {
    jobs: Arc<Jobs>,
    id: String,
    unanswered: Unanswered,
    has_ended: bool,
}

impl RenderRequest {
    fn new(jobs: Arc<Jobs>, id: String, unanswered: Unanswered) -> Self {
        Self {
            jobs,
            id,
            unanswered,
            has_ended: false,
        }
    }

    /// The request has its response. A job that has not ended continues as an ordinary one.
    pub(super) fn end(mut self) {
        self.has_ended = true;
        self.jobs.end_priority(&self.id);
    }

    /// The response is an error of the service, without the image or the job.
    pub(super) fn fail(mut self) {
        self.has_ended = true;
        self.end_job("the request failed");
    }

    fn end_job(&self, reason: &'static str) {
        self.jobs.end_priority(&self.id);
        let Ok(runtime) = Handle::try_current() else {
            return;
        };
        let (jobs, id, unanswered) = (Arc::clone(&self.jobs), self.id.clone(), self.unanswered);
        tracing::info!(job = id, reason, ?unanswered, "a direct render has no response");
        runtime.spawn(async move {
            let ended = match unanswered {
                Unanswered::Continue => Ok(()),
                Unanswered::Cancel => jobs.cancel(id.clone()).await.map(drop),
                Unanswered::Delete => jobs.delete(id.clone()).await.map(drop),
            };
            if let Err(problem) = ended {
                tracing::warn!(job = id, reason, %problem, "cannot end the job of a direct render");
            }
        });
    }
}

impl Drop for RenderRequest {
    fn drop(&mut self) {
        match self.has_ended {
            true => {}
            // The service ends its requests itself. The job continues after its next start, as with a response.
            false if self.jobs.stop.is_cancelled() => self.jobs.end_priority(&self.id),
            false => self.end_job("the client left"),
        }
    }
}

impl Jobs {
    /// Stores a direct render and offers it before the caller's other jobs.
    pub(super) async fn submit_direct(
        self: &Arc<Self>,
        job: Job,
        submission: Submission,
        unanswered: Unanswered,
    ) -> Result<(Followed, RenderRequest), Problem> {
        self.check_runtime(&job)?;
        let price = self.price(&job).await?;
        self.bytes.space.room().await?;
        let jobs = Arc::clone(self);
        // The request exists as soon as the job does, even if the client has left by then.
        to_the_end(async move {
            let submitted = jobs.store(&job, submission, price).await?;
            let request = RenderRequest::new(Arc::clone(&jobs), submitted.job.row.id.clone(), unanswered);
            Ok((submitted.job, request))
        })
        .await
    }

    fn end_priority(&self, id: &str) {
        let dispatch = &self.leases.dispatch;
        dispatch.table(|table, _| table.set_priority(id, limits::JOB_PRIORITY));
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use catalogue::JobState;

    use super::*;
    use crate::http::extract::Submitter;
    use crate::jobs::submit::tests::app;

    async fn request(jobs: &Arc<Jobs>) -> RenderRequest {
        let text = r#"{"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1}}"#;
        let job = Job::parse(text.as_bytes(), &jobs.vocabulary()).unwrap();
        let submission = Submission {
            submitter: Submitter {
                owner: "me".to_owned(),
                idempotency_key: None,
            },
            priority: limits::RENDER_PRIORITY,
            again: true,
        };
        let submitted = jobs.submit_direct(job, submission, Unanswered::Cancel).await;
        submitted.unwrap().1
    }

    /// The state of a job once the tasks of its request have ended.
    async fn state(jobs: &Jobs, id: &str) -> JobState {
        let mut state = jobs.get(id).await.unwrap().state;
        for _ in 0..20 {
            if state == JobState::Cancelled {
                break;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
            state = jobs.get(id).await.unwrap().state;
        }
        state
    }

    /// Failure: a request that the service ends counts as one whose client left.
    #[tokio::test]
    async fn only_clients_that_leave_and_failed_requests_end_their_job() {
        let folder = tempfile::tempdir().unwrap();
        let jobs = app(folder.path()).await.jobs;
        let [left, failed, ended, stopped] = [
            request(&jobs).await,
            request(&jobs).await,
            request(&jobs).await,
            request(&jobs).await,
        ];
        let ids = [&left, &failed, &ended, &stopped].map(|request| request.id.clone());
        drop(left);
        failed.fail();
        ended.end();
        for (id, expected) in
            ids[..3]
                .iter()
                .zip([JobState::Cancelled, JobState::Cancelled, JobState::Queued])
        {
            assert_eq!(state(&jobs, id).await, expected);
        }
        jobs.stop.cancel();
        drop(stopped);
        assert_eq!(state(&jobs, &ids[3]).await, JobState::Queued);
    }
}
