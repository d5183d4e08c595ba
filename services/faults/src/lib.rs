//! Named points at which a test can break a running process.
//!
//! The service and the worker pass points such as `commit.written`. Nothing happens there unless the environment variable
//! `FATHOM_FAULTS` names the point, so that tests can kill the released binary at the worst moments. A fault is written
//!
//! ```text
//! POINT=ACTION        whenever the point is passed
//! POINT=ACTION@N      the N-th time that it is passed (from 1)
//! POINT=ACTION#F      whenever it is passed for frame F
//! POINT=ACTION#R/M    whenever it is passed for a frame whose number leaves R when divided by M
//! ```
//!
//! and several are separated by commas. Actions: `abort` (the process ends immediately, nothing is flushed), `panic`, `hang`
//! (sleeps forever), `memory` (allocates until something stops it), `flag` (the caller does what the point is named for).

mod plan;

use std::sync::OnceLock;
use std::time::Duration;

use plan::{Action, Plan};

/// The environment variable that names the faults.
pub const VARIABLE: &str = "FATHOM_FAULTS";

/// Step of `memory` and the pause after it: slow enough that a limit is noticed before the machine is full.
const MEMORY_STEP_BYTES: usize = 32 << 20;
const MEMORY_PAUSE: Duration = Duration::from_millis(5);

/// Passes a point that belongs to no frame.
pub fn point(name: &str) {
    if let Some(plan) = plan() {
        plan.passed(name, None).map(act).unwrap_or_default();
    }
}

/// Passes a point for a frame; returns whether the caller should do what the point is named for.
#[must_use]
pub fn frame_point(name: &str, frame: u64) -> bool {
    let Some(plan) = plan() else { return false };
    plan.passed(name, Some(frame)).is_some_and(act)
}

/// The faults of this process.
///
/// # Errors
/// The variable is malformed: a test that means to break something must not pass with nothing broken.
pub fn check() -> Result<(), String> {
    match std::env::var(VARIABLE) {
        Ok(text) => Plan::parse(&text).map(drop),
        Err(_) => Ok(()),
    }
}

fn plan() -> Option<&'static Plan> {
    static PLAN: OnceLock<Option<Plan>> = OnceLock::new();
    PLAN.get_or_init(|| Plan::parse(&std::env::var(VARIABLE).ok()?).ok())
        .as_ref()
}

fn act(action: Action) -> bool {
    match action {
        Action::Abort => std::process::abort(),
        Action::Panic => panic!("broken on purpose"),
        Action::Hang => loop {
            std::thread::sleep(Duration::from_secs(3600));
        },
        Action::Memory => {
            let mut taken = Vec::new();
            loop {
                // Written to, so that the pages are allocated.
                taken.push(vec![1u8; MEMORY_STEP_BYTES]);
                std::thread::sleep(MEMORY_PAUSE);
            }
        }
        Action::Flag => true,
    }
}
