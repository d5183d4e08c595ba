//! Job events, derived from the catalogue when the client is ready for the next one. Clients have no stored state, so
//! slow ones cost nothing and reconnecting ones miss nothing.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;

use axum::response::sse::Event;
use catalogue::{CatalogueError, JobRow, JobState};
use futures::stream::{self, Stream};
use serde_json::json;
use tokio::sync::watch::Receiver;
use tokio::time::Instant;

use super::Jobs;
use crate::limits::PROGRESS_PAUSE;

/// Maximum frames listed by a `problem`; `/errors` has all of them.
const NAMED_FRAMES: u32 = 5;

/// Id of the last event sent to this client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Seen {
    version: u64,
    failed: u64,
}

impl Seen {
    pub(super) fn new(job: &JobRow) -> Self {
        Self {
            version: job.version,
            failed: job.failed,
        }
    }

    /// `VERSION.FAILED`.
    pub(super) fn parse(id: &str) -> Option<Self> {
        let (version, failed) = id.split_once('.')?;
        Some(Self {
            version: version.parse().ok()?,
            failed: failed.parse().ok()?,
        })
    }
}

/// State sent last.
struct SentState {
    seen: Seen,
    /// `None`: sent over an earlier connection.
    state: Option<JobState>,
    done: Option<u64>,
}

/// A client that follows a job.
pub(super) struct Follow {
    jobs: Arc<Jobs>,
    id: String,
    changes: Receiver<()>,
    sent: Option<SentState>,
    next_progress: Instant,
    ready: VecDeque<Event>,
    ended: bool,
}

impl Follow {
    pub(super) fn new(jobs: Arc<Jobs>, id: String, seen: Option<Seen>) -> Self {
        let sent = seen.map(|seen| SentState {
            seen,
            state: None,
            done: None,
        });
        let mut changes = jobs.leases.changes.subscribe(&id);
        changes.mark_changed();
        Self {
            changes,
            jobs,
            id,
            sent,
            next_progress: Instant::now(),
            ready: VecDeque::new(),
            ended: false,
        }
    }

    pub(super) fn events(self) -> impl Stream<Item = Result<Event, Infallible>> + Send {
        stream::unfold(self, |mut follow| async move {
            let event = follow.next().await?;
            Some((Ok(event), follow))
        })
    }

    async fn next(&mut self) -> Option<Event> {
        loop {
            if let Some(event) = self.ready.pop_front() {
                return Some(event);
            }
            let stop = self.jobs.stop.clone();
            if self.ended || stop.is_cancelled() {
                return None;
            }
            tokio::select! {
                // The sender exists as long as the job has a follower.
                _ = self.changes.changed() => tokio::time::sleep_until(self.next_progress).await,
                () = stop.cancelled() => continue,
            }
            self.changes.mark_unchanged();
            if let Err(error) = self.look().await {
                tracing::warn!(%error, job = self.id, "a job cannot be followed");
                return None;
            }
        }
    }

    /// Queues the events of new changes.
    async fn look(&mut self) -> Result<(), CatalogueError> {
        let Some(job) = self.jobs.catalogue.job(&self.id).await? else {
            self.ended = true;
            let gone = Event::default().event("state");
            self.push(gone, &json!({"id": self.id, "state": "deleted"}));
            return Ok(());
        };
        let seen = Seen::new(&job);
        if self.sent.as_ref().is_some_and(|sent| sent.seen == seen) {
            return Ok(());
        }
        let before = self.sent.take();
        let failed_before = before.as_ref().map_or(0, |sent| sent.seen.failed);
        if job.failed > failed_before {
            self.problem(&job, failed_before).await?;
        }
        let counts = before
            .as_ref()
            .and_then(|sent| sent.done)
            .map(|done| (done, failed_before));
        if counts != Some((job.done, job.failed)) {
            let progress = json!({"done": job.done, "failed": job.failed, "frames": job.frames});
            self.push(Event::default().event("progress"), &progress);
        }
        self.ended = job.state.has_ended();
        self.sent = Some(SentState {
            seen,
            state: Some(job.state),
            done: Some(job.done),
        });
        if before.and_then(|sent| sent.state) != Some(job.state) {
            self.push(Event::default().event("state"), &job);
        }
        // Only the last event has an id, so that a client that misses the others receives all of them again.
        if let Some(last) = self.ready.pop_back() {
            self.ready
                .push_back(last.id(format!("{}.{}", seen.version, seen.failed)));
        }
        self.next_progress = Instant::now() + PROGRESS_PAUSE;
        Ok(())
    }

    async fn problem(&mut self, job: &JobRow, before: u64) -> Result<(), CatalogueError> {
        let failures = self.jobs.catalogue.failures(&self.id, None, NAMED_FRAMES).await?;
        let problem = json!({
            "failed": job.failed, "new": job.failed - before, "frames": failures,
            "errors": format!("/v1/jobs/{}/errors", self.id),
        });
        self.push(Event::default().event("problem"), &problem);
        Ok(())
    }

    fn push(&mut self, event: Event, data: &impl serde::Serialize) {
        match event.json_data(data) {
            Ok(event) => self.ready.push_back(event),
            Err(error) => tracing::error!(%error, "an event cannot be written"),
        }
    }
}
