//! One beat for all leases of the worker.

use proto::wire::BeatRequest;

use super::Shared;
use super::client::ClientError;

/// Beats until the worker is to stop.
pub(crate) fn run(shared: &Shared) {
    while !shared.stop.is_set() {
        beat(shared);
        shared.stop.pause(shared.membership.beat_interval());
    }
}

fn beat(shared: &Shared) {
    let (worker_id, tokens) = (shared.membership.worker_id(), shared.held.tokens());
    let leases = BeatRequest {
        worker_id: worker_id.clone(),
        tokens: tokens.clone(),
    };
    match shared.client.beat(&leases) {
        Ok(beat) => {
            if !beat.cancelled.is_empty() || !beat.lost.is_empty() {
                tracing::info!(cancelled = ?beat.cancelled, lost = ?beat.lost, "leases have ended");
            }
            shared.held.lose(&beat.cancelled);
            shared.held.lose(&beat.lost);
        }
        Err(ClientError::UnknownWorker) => {
            // The service has restarted and offers all our frames again.
            shared.held.lose(&tokens);
            if let Err(error) = shared.membership.rejoin(&shared.client, &worker_id) {
                tracing::warn!(%error, "cannot join the service again");
            }
        }
        Err(error) => tracing::warn!(%error, "a beat did not arrive"),
    }
}
