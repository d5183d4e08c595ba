//! Writing down lost and failed attempts, so that a restart of the service forgets none.

use crate::leases::table::StrikeEvent;

use crate::app::App;
use crate::telemetry;

/// Writes events down and wakes those who wait for the jobs. A fault is logged: the table in memory stays right, and
/// after a restart the frame merely gets one more try.
pub(crate) async fn record(app: &App, events: Vec<StrikeEvent>) {
    for event in events {
        telemetry::failed(event.quarantined);
        tracing::warn!(
            job = event.job,
            frame = event.frame,
            strikes = event.strikes,
            given_up = event.quarantined,
            error = event.error,
            "an attempt at a frame failed"
        );
        let written = app
            .catalogue
            .record_strike(
                &event.job,
                event.frame,
                event.strikes,
                &event.error,
                event.quarantined,
            )
            .await;
        if let Err(error) = written {
            tracing::error!(%error, job = event.job, frame = event.frame, "cannot write a failed attempt down");
        }
        app.watch.wake(&event.job);
    }
}
