//! Fault injection: named points at which a test can break a running process.
//!
//! The service and the worker pass points such as `commit.written`. A point has no effect unless the environment
//! variable `FATHOM_FAULTS` names it, so tests can kill the released binary at critical moments. Forms of a fault:
//!
//! ```text
//! POINT=ACTION        every time the point is passed
//! POINT=ACTION@N      the N-th time it is passed, from 1
//! POINT=ACTION#F      every time it is passed for frame F
//! POINT=ACTION#R/M    every time it is passed for a frame with frame % M == R
//! ```
//!
//! Commas separate several faults. Actions: `abort` (ends the process without flushing), `panic`, `hang` (sleeps
//! forever), `memory` (allocates until stopped), `flag` (the caller simulates the named fault).

mod plan;

use std::sync::OnceLock;
use std::time::Duration;

use plan::{Action, Plan};

/// Environment variable with the faults.
pub const VARIABLE: &str = "FATHOM_FAULTS";

/// Step of `memory` and the pause after it: slow enough for a limit to act before the machine runs out.
const MEMORY_STEP_BYTES: usize = 32 << 20;
const MEMORY_PAUSE: Duration = Duration::from_millis(5);

/// Passes a point outside any frame.
pub fn point(name: &str) {
    if let Some(plan) = plan() {
        plan.passed(name, None).map(act).unwrap_or_default();
    }
}

/// Passes a point for a frame; returns whether the caller should simulate the named fault.
#[must_use]
pub fn frame_point(name: &str, frame: u64) -> bool {
    let Some(plan) = plan() else { return false };
    plan.passed(name, Some(frame)).is_some_and(act)
}

/// Checks the faults of this process.
///
/// # Errors
/// The variable is malformed. A test that injects faults must not pass with none injected.
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
