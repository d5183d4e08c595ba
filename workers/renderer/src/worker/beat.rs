//! One beat for all leases of the worker.

use super::client::ClientError;

use super::Shared;

/// Beats until the worker is to stop.
pub(crate) fn run(shared: &Shared) {
    while !shared.stop.is_set() {
        beat(shared);
        shared.stop.pause(shared.service.beat_interval());
    }
}

fn beat(shared: &Shared) {
    let worker_id = shared.service.worker_id();
    let tokens = shared.held.tokens();
    match shared.service.beat(&worker_id, tokens.clone()) {
        Ok(beat) => {
            if !beat.cancelled.is_empty() || !beat.lost.is_empty() {
                tracing::info!(cancelled = ?beat.cancelled, lost = ?beat.lost, "leases have ended");
            }
            shared.held.lose(&beat.cancelled);
            shared.held.lose(&beat.lost);
        }
        Err(ClientError::UnknownWorker) => {
            // The service has started anew and offers all our frames again.
            shared.held.lose(&tokens);
            if let Err(error) = shared.service.rejoin(&worker_id) {
                tracing::warn!(%error, "cannot join the service again");
            }
        }
        Err(error) => tracing::warn!(%error, "a beat was not heard"),
    }
}
