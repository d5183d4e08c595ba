//! Ends the process when a frame exceeds its time, the worker exceeds its memory, or a cancelled frame ignores its flag. A computing
//! thread cannot be stopped from inside its process, and the service recovers from a dead worker.

use std::time::Duration;

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
            Some(Verdict::Guilty(message)) => {
                tracing::error!("{message}; the worker ends itself");
                std::process::abort();
            }
            Some(Verdict::Idle(message)) => {
                tracing::warn!("{message}; the worker ends itself");
                for token in shared.held.tokens() {
                    // A lease whose release fails expires after the process ends.
                    let _ = shared
                        .client
                        .release(token, "the worker ends itself for another frame");
                }
                std::process::abort();
            }
        }
        shared.stop.pause(LOOK);
    }
}
