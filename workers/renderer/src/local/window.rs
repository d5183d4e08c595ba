//! Hands frames out in order and keeps fast threads from running away from a slow frame.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// The frames that may be worked on: from the oldest unwritten one, so many ahead.
pub(crate) struct Window {
    state: Mutex<State>,
    moved: Condvar,
    end: u64,
    ahead: u64,
}

struct State {
    next: u64,
    written: u64,
    closed: bool,
}

impl Window {
    /// Frames `start..end`, at most `ahead` beyond the oldest unwritten one.
    pub(crate) fn new(start: u64, end: u64, ahead: u64) -> Self {
        let state = State {
            next: start,
            written: start,
            closed: false,
        };
        Self {
            state: Mutex::new(state),
            moved: Condvar::new(),
            end,
            ahead,
        }
    }

    /// The next frame; waits until it is not too far ahead. `None`: there are no more.
    pub(crate) fn take(&self) -> Option<u64> {
        let mut state = self.state();
        loop {
            if state.closed || state.next >= self.end {
                return None;
            }
            if state.next - state.written < self.ahead {
                state.next += 1;
                return Some(state.next - 1);
            }
            state = self.moved.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// All frames before this one are written.
    pub(crate) fn wrote(&self, next: u64) {
        self.state().written = next;
        self.moved.notify_all();
    }

    /// Hands out no more.
    pub(crate) fn close(&self) {
        self.state().closed = true;
        self.moved.notify_all();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // The numbers are right after every statement, whatever panicked in between.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_in_order_and_only_so_far_ahead() {
        let window = Window::new(5, 9, 2);
        assert_eq!((window.take(), window.take()), (Some(5), Some(6)));
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| window.take());
            window.wrote(6);
            assert_eq!(waiting.join().unwrap(), Some(7));
        });
        window.wrote(8);
        assert_eq!((window.take(), window.take()), (Some(8), None));
    }

    #[test]
    fn a_closed_window_lets_nobody_wait() {
        let window = Window::new(0, 9, 1);
        assert_eq!(window.take(), Some(0));
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| window.take());
            window.close();
            assert_eq!(waiting.join().unwrap(), None);
        });
    }
}
