//! What the dispatcher reports: workers, waiting jobs, gauges.

use wire::messages::RegisterRequest;

use super::{Dispatch, State};
use crate::leases::table::{Millis, Misfits};
use crate::leases::worker::Worker;
use crate::telemetry;

/// Maximum workers that a warning names.
const MAX_NAMED: usize = 3;

impl Dispatch {
    /// Warnings about an open job: workers that get none of its frames, and frames of two versions.
    pub(crate) fn warnings(&self, job: &str) -> Vec<String> {
        self.table(|table, _| {
            let misfits = table.misfits(job).map(|misfits| describe_misfits(job, &misfits));
            let upgraded = table.upgraded(job).map(|(made, now)| {
                format!(
                    "its first images were made with {made}, the others are made with {now}: `fathom start-again {job}` renders \
                     all of them with one version"
                )
            });
            misfits.into_iter().chain(upgraded).collect()
        })
    }

    /// Whether a worker was started by the service.
    pub(crate) fn is_own(&self, id: &str) -> bool {
        self.state().own.contains(id)
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

fn describe_misfits(job: &str, misfits: &Misfits) -> String {
    let Misfits {
        needed,
        workers,
        is_waiting,
    } = misfits;
    let shown = workers.iter().take(MAX_NAMED).map(|worker| {
        let RegisterRequest {
            name, code_version, ..
        } = worker;
        let runtime = worker.onnx_runtime.as_deref().unwrap_or("none");
        format!(
            "`{name}` (version {code_version}, CPU features {}, ONNX Runtime {runtime})",
            worker.cpu_features
        )
    });
    let shown: Vec<String> = shown.collect();
    let remedy = format!(
        "`fathom finish-elsewhere {job}` lets any worker finish it, with these frames marked, and `fathom start-again {job}` \
         renders it from the beginning"
    );
    match is_waiting {
        true => format!(
            "no worker makes the same bytes as the service, {needed}: {} get none of its frames. Start such a worker; {remedy}",
            shown.join(", ")
        ),
        false => format!(
            "{} of the workers get none of its frames, which need {needed}: {}. {remedy}",
            workers.len(),
            shown.join(", ")
        ),
    }
}
