//! Repeats calls to a service that is unavailable.

use std::time::Duration;

use super::client::{ClientError, Outcome};
use super::stop::Stop;

const FIRST: Duration = Duration::from_millis(200);
const LONGEST: Duration = Duration::from_secs(5);
/// Remaining tries of a call once the worker is stopping.
const LAST_TRIES: u32 = 5;

/// Pause after the given number of tries: doubles up to a limit.
fn pause_after(tries: u32) -> Duration {
    FIRST
        .saturating_mul(1 << tries.saturating_sub(1).min(16))
        .min(LONGEST)
}

/// Result of a repeated call.
pub(crate) struct Persisted<T> {
    pub(crate) result: Outcome<T>,
    /// More than one try was made, so an earlier one may have arrived although its response was lost.
    pub(crate) repeated: bool,
}

/// Repeats a call until the service responds or the result is not needed; only a few more times once the worker is stopping.
pub(crate) fn persist<T>(
    stop: &Stop,
    wanted: impl Fn() -> bool,
    call: impl Fn() -> Outcome<T>,
) -> Persisted<T> {
    let (mut tries, mut last_tries) = (0, LAST_TRIES);
    loop {
        let result = call();
        tries += 1;
        if stop.is_set() {
            last_tries -= 1;
        }
        let away = match &result {
            Err(ClientError::Unavailable { reason }) => Some(reason),
            _ => None,
        };
        let Some(reason) = away.filter(|_| wanted() && last_tries > 0) else {
            return Persisted {
                result,
                repeated: tries > 1,
            };
        };
        if tries == 1 {
            tracing::warn!(reason, "waiting for the service");
        }
        if stop.is_set() {
            std::thread::sleep(FIRST);
        } else {
            stop.pause(pause_after(tries));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    fn away() -> ClientError {
        ClientError::Unavailable {
            reason: "away".to_owned(),
        }
    }

    #[test]
    fn pauses_double_up_to_a_ceiling() {
        let pauses = [1, 2, 3, 5, 6, 400].map(|tries| pause_after(tries).as_millis());
        assert_eq!(pauses, [200, 400, 800, 3200, 5000, 5000]);
    }

    #[test]
    fn a_call_is_repeated_until_the_service_responds() {
        let tries = Cell::new(0);
        let call = || {
            tries.set(tries.get() + 1);
            if tries.get() < 2 { Err(away()) } else { Ok(7) }
        };
        let persisted = persist(&Stop::default(), || true, call);
        assert!(matches!(persisted.result, Ok(7)));
        assert!(persisted.repeated);
    }

    #[test]
    fn nobody_insists_on_what_is_not_wanted_or_once_the_worker_stops() {
        let tries = Cell::new(0);
        let call = || {
            tries.set(tries.get() + 1);
            Err::<(), _>(away())
        };
        assert!(persist(&Stop::default(), || false, call).result.is_err());
        assert_eq!(tries.replace(0), 1);
        let stop = Stop::default();
        stop.set();
        assert!(persist(&stop, || true, call).result.is_err());
        assert_eq!(tries.get(), LAST_TRIES);
    }
}
