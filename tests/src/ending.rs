//! Orderly ends of processes, and how long they take.

use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

use crate::{Service, Worker};

/// How a process ended, and how long after it was asked to.
#[derive(Debug)]
pub struct Ended {
    /// Its exit status.
    pub status: ExitStatus,
    /// From the first signal to its end.
    pub after: Duration,
}

impl Service {
    /// SIGTERM; the service keeps running in the background until it ends.
    ///
    /// # Panics
    /// When the process cannot be signaled.
    pub fn ask_to_stop(&self) {
        terminate(&self.child);
    }

    /// Waits until the service has ended, which it was asked to at `since`.
    ///
    /// # Panics
    /// When it has not ended in time.
    #[must_use]
    pub fn ended(&mut self, since: Instant) -> Ended {
        ended(&mut self.child, since)
    }
}

impl Worker {
    /// SIGTERM, then waits for the end.
    ///
    /// # Panics
    /// When it has not ended in time.
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

/// Far beyond what is promised: the promise is checked by whoever asks.
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
