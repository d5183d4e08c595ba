use std::time::Duration;

/// Limits on the expected cost of jobs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PriceLimits {
    /// Expected slot time of a frame.
    pub frame: Duration,
    /// Expected slot time of the unfinished frames of a caller.
    pub caller: Duration,
    /// Expected bytes of the unfinished frames of a caller.
    pub caller_bytes: u64,
}

impl Default for PriceLimits {
    /// The defaults of `fathom serve`: an hour for a frame, ten thousand hours and ten terabytes for a caller.
    fn default() -> Self {
        Self {
            frame: Duration::from_secs(3600),
            caller: Duration::from_secs(10_000 * 3600),
            caller_bytes: 10_000_000_000_000,
        }
    }
}
