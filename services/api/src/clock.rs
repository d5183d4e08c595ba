//! Monotonic and wall clock of the service; tests inject them.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use catalogue::UnixMs;
use uuid::{ContextV7, Timestamp, Uuid};

/// The source of time.
#[derive(Clone)]
pub struct Clock {
    monotonic: Arc<dyn Fn() -> u64 + Send + Sync>,
    wall: Arc<dyn Fn() -> u64 + Send + Sync>,
}

impl Clock {
    /// The clocks of this machine.
    #[must_use]
    pub fn system() -> Self {
        let start = Instant::now();
        Self {
            monotonic: Arc::new(move || u64::try_from(start.elapsed().as_millis()).unwrap_or(u64::MAX)),
            wall: Arc::new(|| u64::try_from(since_1970(SystemTime::now()).as_millis()).unwrap_or(u64::MAX)),
        }
    }

    /// Builds a clock from two functions: monotonic milliseconds, and milliseconds since 1970 in UTC.
    pub fn from_functions(
        monotonic: impl Fn() -> u64 + Send + Sync + 'static,
        wall: impl Fn() -> u64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            monotonic: Arc::new(monotonic),
            wall: Arc::new(wall),
        }
    }

    /// Milliseconds since an arbitrary start, for leases.
    pub(crate) fn monotonic_ms(&self) -> u64 {
        (self.monotonic)()
    }

    /// Wall-clock time for rows.
    pub(crate) fn wall(&self) -> UnixMs {
        UnixMs((self.wall)())
    }
}

/// A UUID (version 7) greater than all earlier ones of this process.
pub(crate) fn ordered_id() -> Uuid {
    id_at(SystemTime::now())
}

/// A machine without a clock battery may start before 1970, which counts as 1970.
fn since_1970(now: SystemTime) -> Duration {
    now.duration_since(UNIX_EPOCH).unwrap_or_default()
}

fn id_at(now: SystemTime) -> Uuid {
    static ORDER: Mutex<ContextV7> = Mutex::new(ContextV7::new());
    let since = since_1970(now);
    Uuid::new_v7(Timestamp::from_unix(
        &ORDER,
        since.as_secs(),
        since.subsec_nanos(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_made_before_1970_and_grow_also_when_the_clock_goes_back() {
        let long_ago = UNIX_EPOCH - Duration::from_secs(86_400);
        let (first, second) = (id_at(long_ago), id_at(long_ago));
        assert!(first < second);
        assert!(second < id_at(SystemTime::now()));
    }
}
