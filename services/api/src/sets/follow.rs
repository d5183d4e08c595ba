//! Follows a set: polls it until every frame of its job has ended.

use std::sync::Arc;
use std::time::{Duration, Instant};

use catalogue::{CatalogueError, Deleted, JobRow};

use super::Sets;
use super::followed::Followed;
use super::reader::Reader;
use crate::http::problem::Problem;

/// Minimum pause between two polls.
const PAUSE: Duration = Duration::from_secs(2);
/// Minimum pause if changes of the set are announced.
const PAUSE_ANNOUNCED: Duration = Duration::from_secs(30);
/// The pause is at least this many times the duration of a poll, which is longer for a large set.
const PAUSE_SHARE: u32 = 10;

impl Sets {
    /// Imports the set at a URL, and follows it while it grows. Completes even if the client disconnects.
    pub(super) async fn import(self: &Arc<Self>, url: String) -> Result<JobRow, Problem> {
        let reader = self.reader()?;
        self.jobs.bytes.space.room().await?;
        let row = self.begin(reader, &url, None).await?;
        self.follow(&row, false);
        Ok(row)
    }

    /// Resumes the sets followed by an earlier run of the service.
    pub(crate) async fn resume_all(self: &Arc<Self>) -> Result<(), CatalogueError> {
        if self.reader.is_some() {
            let jobs = self.jobs.catalogue.imported_jobs().await?;
            let open = jobs.iter().filter(|job| !job.state.has_ended());
            let has_engine = self.jobs.engine.is_some();
            open.for_each(|job| self.follow(job, has_engine && job.is_shared()));
        }
        Ok(())
    }

    /// Deletes the job of a set with its images; the set itself is kept.
    pub(super) async fn delete(&self, job: &str) -> Result<Deleted, Problem> {
        self.get(job).await?;
        let deleted = self.jobs.delete(job.to_owned()).await?;
        if let Some(followed) = self.followed().get(job) {
            followed.wake.notify_one();
        }
        Ok(deleted)
    }

    /// Polls a set until it is complete. `is_announced`: its changes are announced, so that rare polls are enough.
    pub(super) fn follow(self: &Arc<Self>, row: &JobRow, is_announced: bool) {
        let Some(location) = row.set.clone() else { return };
        let followed = Arc::clone(self.followed().entry(row.id.clone()).or_default());
        if std::mem::replace(&mut followed.last().goes_on, true) {
            followed.wake.notify_one();
            return;
        }
        let (sets, job) = (Arc::clone(self), row.id.clone());
        let least = if is_announced { PAUSE_ANNOUNCED } else { PAUSE };
        tokio::spawn(async move {
            let stop = sets.jobs.stop.clone();
            stop.run_until_cancelled(sets.follow_to_the_end(&location, &job, &followed, least))
                .await;
        });
    }

    async fn follow_to_the_end(&self, location: &str, job: &str, followed: &Followed, least: Duration) {
        let Some(reader) = &self.reader else { return };
        loop {
            let begun = Instant::now();
            if !self.look_once(reader, location, job, followed).await {
                return;
            }
            let pause = least.max(begun.elapsed() * PAUSE_SHARE);
            let _ = tokio::time::timeout(pause, followed.wake.notified()).await;
        }
    }

    /// Returns whether to poll again.
    async fn look_once(&self, reader: &Reader, location: &str, job: &str, followed: &Followed) -> bool {
        let found = self.look(reader, location, job).await;
        let mut last = followed.last();
        last.at = Some(self.jobs.clock.wall());
        match found {
            Ok(None) => {
                last.goes_on = false;
                drop(last);
                self.followed().remove(job);
                false
            }
            Ok(Some(row)) => {
                last.error = None;
                last.goes_on = !row.state.has_ended();
                last.goes_on
            }
            Err(error) => {
                let text = error.to_string();
                if last.error.as_ref() != Some(&text) {
                    tracing::warn!(job, set = location, error = text, "a set cannot be imported");
                }
                last.error = Some(text);
                last.goes_on = !error.is_final();
                last.goes_on
            }
        }
    }
}
