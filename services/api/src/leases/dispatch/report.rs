//! What the dispatcher reports: workers, waiting jobs, gauges.

use wire::messages::RegisterRequest;

use super::{Dispatch, State};
use crate::leases::table::Millis;
use crate::leases::worker::Worker;
use crate::telemetry;

impl Dispatch {
    /// Why a job waits although there are workers.
    pub(crate) fn waits_for(&self, job: &str) -> Option<String> {
        self.table(|table, _| {
            let made = table.waits_for(job)?;
            Some(format!(
                "no worker makes the same bytes as this job's images, which were made with {made}: start such a worker, or the \
                 service with --mix-workers"
            ))
        })
    }

    /// Whether a registered worker has the runtime of the style models.
    pub(crate) fn has_style_runtime(&self) -> bool {
        self.table(|table, _| table.workers().any(|(_, about, _)| about.onnx_runtime.is_some()))
    }

    /// Total slots of the registered workers.
    pub(crate) fn slots(&self) -> u64 {
        self.table(|table, _| table.workers().map(|(_, about, _)| u64::from(about.slots)).sum())
    }

    /// The registered workers.
    pub(crate) fn workers(&self) -> Vec<Worker> {
        self.table(|table, now| {
            table
                .workers()
                .map(|(id, about, seen): (&str, &RegisterRequest, Millis)| Worker {
                    id: id.to_owned(),
                    name: about.name.clone(),
                    slots: about.slots,
                    leased_frames: table.held_by(id) as u64,
                    silent_ms: now.0.saturating_sub(seen.0),
                    code_version: about.code_version.clone(),
                    onnx_runtime: about.onnx_runtime.clone(),
                    cpu_features: about.cpu_features.clone(),
                })
                .collect()
        })
    }

    /// Updates the gauges.
    pub(crate) fn measure(&self) {
        let mut state = self.state();
        let totals = state.table.totals();
        let State { table, open, .. } = &mut *state;
        open.retain(|job, _| table.has_job(job));
        let oldest = open.values().map(|open| open.submitted_at).min();
        drop(state);
        let now = self.clock.wall().0;
        let age_ms = oldest.map_or(0, |submitted| now.saturating_sub(submitted.0));
        telemetry::queue(totals.queued, totals.leased, age_ms);
    }
}
