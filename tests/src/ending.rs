//! Orderly shutdown of processes, and its duration.

use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

use crate::{Service, Worker};

/// Result of a shutdown.
#[derive(Debug)]
pub struct Ended {
    /// Its exit status.
    pub status: ExitStatus,
    /// Time from the first signal to the end.
    pub after: Duration,
}

impl Service {
    /// Sends SIGTERM; the service keeps running in the background until it ends.
    ///
    /// # Panics
    /// If the process cannot be signaled.
    pub fn ask_to_stop(&self) {
        terminate(&self.child);
    }

    /// Waits until the service has ended after a signal at `since`.
    ///
    /// # Panics
    /// If it does not end in time.
    #[must_use]
    pub fn ended(&mut self, since: Instant) -> Ended {
        ended(&mut self.child, since)
    }
}

impl Worker {
    /// Sends SIGTERM, then waits for the end.
    ///
    /// # Panics
    /// If it does not end in time.
    #[must_use]
    pub fn stopped(mut self) -> Ended {
        let since = Instant::now();
        terminate(&self.child);
        ended(&mut self.child, since)
    }
}

fn terminate(child: &Child) {
    let sent = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(sent.is_ok_and(|status| status.success()), "no SIGTERM");
}

/// Far beyond the documented limit, which the tests check.
fn ended(child: &mut Child, since: Instant) -> Ended {
    while since.elapsed() < Duration::from_secs(120) {
        if let Ok(Some(status)) = child.try_wait() {
            let after = since.elapsed();
            return Ended { status, after };
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("the process has not ended {:?} after SIGTERM", since.elapsed());
}
