//! One heartbeat for all leases of the worker. The service holds its response until the next heartbeat is due or a lease is
//! cancelled, so cancelled work ends immediately.

use std::time::{Duration, Instant};

use wire::messages::BeatRequest;

use super::client::ClientError;
use super::shared::Shared;

/// Shortest time between two heartbeats, even while many leases are cancelled.
const SHORTEST: Duration = Duration::from_millis(100);

/// Sends heartbeats until the worker stops.
pub(crate) fn run(shared: &Shared) {
    while !shared.stop.is_set() {
        let begun = Instant::now();
        let interval = match beat(shared) {
            Beat::Cancelled => SHORTEST,
            Beat::Over => shared.membership.beat_interval(),
        };
        shared.stop.pause(interval.saturating_sub(begun.elapsed()));
    }
}

enum Beat {
    /// Leases were cancelled; send the next heartbeat early.
    Cancelled,
    /// No cancellation, or an error.
    Over,
}

fn beat(shared: &Shared) -> Beat {
    let (worker_id, tokens) = (shared.membership.worker_id(), shared.held.tokens());
    let interval = shared.membership.beat_interval();
    let leases = BeatRequest {
        worker_id: worker_id.clone(),
        tokens: tokens.clone(),
        wait_ms: u32::try_from(interval.as_millis()).unwrap_or(0),
    };
    match shared.client.beat(&leases) {
        Ok(beat) => {
            let is_over = beat.cancelled.is_empty();
            if !is_over || !beat.lost.is_empty() {
                tracing::info!(cancelled = ?beat.cancelled, lost = ?beat.lost, "leases have ended");
            }
            shared.held.lose(&beat.cancelled);
            shared.held.lose(&beat.lost);
            return if is_over { Beat::Over } else { Beat::Cancelled };
        }
        Err(ClientError::UnknownWorker) => {
            // The service has restarted and offers all frames again.
            shared.held.lose(&tokens);
            if let Err(error) = shared.membership.rejoin(&shared.client, &worker_id) {
                tracing::warn!(%error, "cannot join the service again");
            }
        }
        Err(error) => tracing::warn!(%error, "a beat did not arrive"),
    }
    Beat::Over
}
