//! Shared jobs: all services of a store show the same jobs.

use std::sync::Arc;

use catalogue::{JobRow, JobState};
use spec::SetState;
use tokio::sync::mpsc;

use super::Sets;
use super::look_error::LookError;
use super::reader::Reader;
use crate::engine::orders::{Event, SeenSet};

/// Maximum queued events.
const SEEN: usize = 64;

impl Sets {
    /// Applies the engine's events until the service stops.
    pub(crate) async fn show_shared(self: Arc<Self>) {
        let (Some(engine), Some(reader)) = (&self.jobs.engine, &self.reader) else {
            return;
        };
        let (send, mut seen) = mpsc::channel(SEEN);
        let show = async {
            while let Some(event) = seen.recv().await {
                let set = match event {
                    Event::Set(set) => set,
                    Event::Workers(workers) => {
                        self.jobs.leases.set_workers_elsewhere(workers);
                        continue;
                    }
                };
                if let Err(error) = self.show(reader, &set).await {
                    tracing::warn!(job = set.id, set = set.location, %error, "cannot update a job of the store");
                }
            }
        };
        let both = async { tokio::join!(engine.watch(&send), show) };
        self.jobs.stop.run_until_cancelled(both).await;
    }

    /// Updates the job of a set.
    async fn show(self: &Arc<Self>, reader: &Reader, set: &SeenSet) -> Result<(), LookError> {
        let catalogue = &self.jobs.catalogue;
        let row = match catalogue.job(&set.id).await? {
            Some(row) => row,
            None => self.begin(reader, &set.location, Some(&set.id)).await?,
        };
        let row = self.take_state(row, set.state).await?;
        let imported = catalogue.imported_extent(&row.id).await?;
        if !row.state.has_ended() || imported != (set.done, set.changed_ms) {
            self.follow(&row, true);
        }
        Ok(())
    }

    /// Another service may have changed it.
    async fn take_state(&self, row: JobRow, state: SetState) -> Result<JobRow, LookError> {
        let wanted = match (state, row.state) {
            (SetState::Paused, JobState::Queued | JobState::Running) => JobState::Paused,
            (SetState::Running, JobState::Paused) => JobState::Running,
            (SetState::Cancelled, JobState::Queued | JobState::Running | JobState::Paused) => {
                JobState::Cancelled
            }
            _ => return Ok(row),
        };
        let row = self.jobs.catalogue.set_shared_state(&row.id, wanted).await?;
        self.jobs.leases.changes.notify(&row.id);
        Ok(row)
    }
}
