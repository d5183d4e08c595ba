//! Ends the process when a frame exceeds its time, the worker exceeds its memory, or a cancelled frame ignores its flag. A computing
//! thread cannot be stopped from inside its process, and the service recovers from a dead worker.

use std::collections::BTreeMap;
use std::time::Duration;

use wire::messages::{Claim, FailRequest};

use super::memory::resident_bytes;
use super::running::Verdict;
use super::shared::Shared;

/// How often the frames and the memory are checked.
const LOOK: Duration = Duration::from_millis(100);
/// Watches until the worker stops.
pub(crate) fn run(shared: &Shared) {
    while !shared.stop.is_set() {
        match shared.running.verdict(&shared.limits, resident_bytes()) {
            None => {}
            Some(Verdict::Late { claim, message }) => {
                tracing::error!("{message}; the worker ends itself");
                report_late(shared, claim, message);
                release_all(shared);
                std::process::abort();
            }
            Some(Verdict::Guilty(message)) => {
                tracing::error!("{message}; the worker ends itself");
                std::process::abort();
            }
            Some(Verdict::Idle(message)) => {
                tracing::warn!("{message}; the worker ends itself");
                release_all(shared);
                std::process::abort();
            }
        }
        shared.stop.pause(LOOK);
    }
}

/// Reports a frame that exceeded its time. The same frame would exceed it again, so it is not retried.
fn report_late(shared: &Shared, claim: Claim, message: String) {
    let fail = FailRequest {
        claim: Some(claim),
        error: format!(
            "{message}; it is not tried again: simplify it, or raise the limit and retry the failed frames"
        ),
        retryable: false,
        timings_ms: BTreeMap::new(),
    };
    if let Err(error) = shared.client.fail(&fail) {
        tracing::warn!(%error, "cannot report the frame; its lease will run out");
    }
}

/// Releases all leases. One whose release fails expires after the process ends.
fn release_all(shared: &Shared) {
    for token in shared.held.tokens() {
        let _ = shared
            .client
            .release(token, "the worker ends itself for another frame");
    }
}
