//! Stores lost and failed attempts, so that they survive a restart of the service.

use catalogue::FailureRow;

use super::Leases;
use super::table::StrikeEvent;
use crate::telemetry;

impl Leases {
    /// Ends a job, unless the table has open frames of it.
    pub(crate) fn end_if_complete(&self, job: &str) {
        if !self.dispatch.table(|table, _| table.has_job(job)) {
            self.proofs.mark_ending(job);
        }
    }

    /// Stores events and notifies followers of the jobs. An error is only logged: the table in memory is still
    /// correct, and after a restart the frame gets one more attempt.
    pub(crate) async fn record_strikes(&self, events: Vec<StrikeEvent>) {
        for event in events {
            let StrikeEvent {
                job,
                frame,
                strikes,
                error,
                quarantined,
            } = event;
            telemetry::failed(quarantined);
            tracing::warn!(
                job,
                frame,
                strikes,
                given_up = quarantined,
                error,
                "an attempt at a frame failed"
            );
            let failure = FailureRow {
                frame,
                strikes,
                quarantined,
                error,
            };
            if let Err(error) = self.catalogue.record_strike(&job, failure).await {
                tracing::error!(%error, job, frame, "cannot record a failed attempt");
            }
            self.changes.notify(&job);
            self.end_if_complete(&job);
        }
    }
}
