//! Looks whether a set was cancelled while its shards are rendered.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use spec::SetState;

use crate::error::SetError;
use crate::set::opened::Set;
use crate::set::state::allow_work;

/// Looks at the state of a set from time to time while shards are rendered.
pub struct Watch {
    stop: Arc<AtomicBool>,
    is_cancelled: Arc<AtomicBool>,
    /// Ends the thread when it is dropped.
    _end: mpsc::Sender<()>,
}

impl Watch {
    /// Starts watching the state of a set. `stop` is set when the process should end.
    #[must_use]
    pub fn start(set: &Set, every: Duration, stop: Arc<AtomicBool>) -> Self {
        let (end, ended) = mpsc::channel();
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let (set, flag) = (set.clone(), Arc::clone(&is_cancelled));
        thread::spawn(move || {
            while ended.recv_timeout(every) == Err(mpsc::RecvTimeoutError::Timeout) {
                // Writers report a store that does not respond.
                if matches!(set.state(), Ok(SetState::Cancelled)) {
                    flag.store(true, Ordering::SeqCst);
                }
            }
        });
        Self {
            stop,
            is_cancelled,
            _end: end,
        }
    }

    /// Returns an error once the work is to end.
    ///
    /// # Errors
    /// [`SetError::Refused`] after the set was cancelled; [`SetError::Later`] when this process should end.
    pub fn check(&self) -> Result<(), SetError> {
        if self.is_cancelled.load(Ordering::SeqCst) {
            return allow_work(SetState::Cancelled);
        }
        if self.stop.load(Ordering::SeqCst) {
            return Err(SetError::Later(
                "stopped; run the command again to continue".to_owned(),
            ));
        }
        Ok(())
    }
}
