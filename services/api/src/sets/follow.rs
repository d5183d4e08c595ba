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
/// Longest pause after polls that failed with the same reason; each one doubles it.
const PAUSE_FAILED: Duration = Duration::from_secs(60);
/// The same while the content of the set is damaged.
const PAUSE_DAMAGED: Duration = Duration::from_secs(3600);
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
        if let Some(followed) = self.followed().remove(job) {
            followed.stop.cancel();
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
            let follow = sets.follow_to_the_end(&location, &job, &followed, least);
            // Cancelling drops the future, which ends the process that reads the set.
            stop.run_until_cancelled(followed.stop.run_until_cancelled(follow))
                .await;
        });
    }

    async fn follow_to_the_end(&self, location: &str, job: &str, followed: &Followed, least: Duration) {
        let Some(reader) = &self.reader else { return };
        let mut pauses = Pauses { least, failures: 0 };
        loop {
            let begun = Instant::now();
            let polled = self.look_once(reader, location, job, followed).await;
            let Some(pause) = pauses.next_pause(&polled, begun.elapsed()) else {
                return;
            };
            let woken = tokio::time::timeout(pause, followed.wake.notified()).await;
            if woken.is_ok() {
                pauses.failures = 0;
            }
        }
    }

    async fn look_once(&self, reader: &Reader, location: &str, job: &str, followed: &Followed) -> Polled {
        let found = self.look(reader, location, job).await;
        let mut last = followed.last();
        last.at = Some(self.jobs.clock.wall());
        match found {
            Ok(None) => {
                last.goes_on = false;
                drop(last);
                self.followed().remove(job);
                Polled::Ended
            }
            Ok(Some(row)) => {
                last.error = None;
                last.goes_on = !row.state.has_ended();
                if last.goes_on { Polled::Read } else { Polled::Ended }
            }
            Err(error) => {
                let text = error.to_string();
                let is_same = last.error.as_ref() == Some(&text);
                if !is_same {
                    tracing::warn!(job, set = location, error = text, "a set cannot be imported");
                }
                last.error = Some(text);
                last.goes_on = !error.is_final();
                match last.goes_on {
                    false => Polled::Ended,
                    true => Polled::Failed {
                        is_same,
                        is_of_content: error.is_of_content(),
                    },
                }
            }
        }
    }
}

/// The result of a poll.
enum Polled {
    /// No other poll will follow.
    Ended,
    Read,
    Failed {
        /// Whether the previous poll failed with the same reason.
        is_same: bool,
        /// Whether the content of the set must change before a poll can succeed.
        is_of_content: bool,
    },
}

/// The pauses between polls.
struct Pauses {
    least: Duration,
    /// Polls in a row that failed with the same reason.
    failures: u32,
}

impl Pauses {
    /// The pause after a poll, or `None` after the last one.
    fn next_pause(&mut self, polled: &Polled, took: Duration) -> Option<Duration> {
        let pause = self.least.max(took * PAUSE_SHARE);
        match polled {
            Polled::Ended => None,
            Polled::Read => {
                self.failures = 0;
                Some(pause)
            }
            Polled::Failed {
                is_same,
                is_of_content,
            } => {
                self.failures = if *is_same { self.failures + 1 } else { 1 };
                let longest = if *is_of_content {
                    PAUSE_DAMAGED
                } else {
                    PAUSE_FAILED
                };
                Some(
                    pause
                        .saturating_mul(1 << self.failures.min(16))
                        .min(longest.max(pause)),
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum_of_pauses(is_of_content: bool, polls: usize) -> Duration {
        let mut pauses = Pauses {
            least: PAUSE,
            failures: 0,
        };
        let mut sum = Duration::ZERO;
        for number in 0..polls {
            let polled = Polled::Failed {
                is_same: number > 0,
                is_of_content,
            };
            sum += pauses.next_pause(&polled, Duration::ZERO).unwrap();
        }
        sum
    }

    #[test]
    fn a_set_that_fails_for_the_same_reason_is_read_less_and_less_often() {
        assert!(sum_of_pauses(true, 12) > Duration::from_secs(3600));
        assert!(sum_of_pauses(true, 3) < Duration::from_secs(60));
        let later = sum_of_pauses(false, 100);
        assert!(
            later < PAUSE_FAILED * 100 && later > PAUSE_FAILED * 80,
            "{later:?}"
        );
        let mut pauses = Pauses {
            least: PAUSE,
            failures: 9,
        };
        assert_eq!(pauses.next_pause(&Polled::Read, Duration::ZERO), Some(PAUSE));
        assert_eq!(pauses.next_pause(&Polled::Ended, Duration::ZERO), None);
    }
}
