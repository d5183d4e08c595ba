//! The two clocks of the service, passed in so that tests can set them.

use std::sync::Arc;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use catalogue::UnixMs;

/// The source of the time.
#[derive(Clone)]
pub struct Clock {
    monotonic: Arc<dyn Fn() -> u64 + Send + Sync>,
    wall: Arc<dyn Fn() -> u64 + Send + Sync>,
}

impl Clock {
    /// The machine's clocks.
    #[must_use]
    pub fn system() -> Self {
        let start = Instant::now();
        let monotonic = move || u64::try_from(start.elapsed().as_millis()).unwrap_or(u64::MAX);
        let wall = || {
            let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
        };
        Self {
            monotonic: Arc::new(monotonic),
            wall: Arc::new(wall),
        }
    }

    /// Clocks that read what these functions return: milliseconds that never go back, and milliseconds since 1970 in
    /// UTC.
    pub fn from_functions(
        monotonic: impl Fn() -> u64 + Send + Sync + 'static,
        wall: impl Fn() -> u64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            monotonic: Arc::new(monotonic),
            wall: Arc::new(wall),
        }
    }

    /// Milliseconds since an arbitrary moment, for leases.
    pub(crate) fn monotonic_ms(&self) -> u64 {
        (self.monotonic)()
    }

    /// The time with which rows are stamped.
    pub(crate) fn wall(&self) -> UnixMs {
        UnixMs((self.wall)())
    }
}
