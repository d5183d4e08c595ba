//! The time that a thread computes.

use std::time::Instant;

/// A measurement of this thread from its start: the time on a processor where the system counts it, so that other programs add
/// little, or else the time of the clock.
pub(super) struct ThreadClock {
    begun: Instant,
    begun_ns: Option<u64>,
}

impl ThreadClock {
    pub(super) fn start() -> Self {
        Self {
            begun: Instant::now(),
            begun_ns: read_processor_ns(),
        }
    }

    /// Milliseconds since the start.
    pub(super) fn ms(&self) -> f64 {
        let passed = self.begun_ns.zip(read_processor_ns());
        passed.map_or_else(
            || self.begun.elapsed().as_secs_f64() * 1e3,
            |(begun, now)| now.saturating_sub(begun) as f64 / 1e6,
        )
    }
}

/// Nanoseconds of this thread on a processor; `None` where the system has no such file.
fn read_processor_ns() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_is_no_work_where_the_system_counts_it() {
        let clock = ThreadClock::start();
        std::thread::sleep(std::time::Duration::from_millis(60));
        let ms = clock.ms();
        assert!(
            if clock.begun_ns.is_some() {
                ms < 30.0
            } else {
                ms >= 60.0
            },
            "{ms}"
        );
    }
}
