//! Cancels a computation whose result is no longer needed.
//!
//! A frame can take minutes, so a worker computes it under a flag ([`watched`]). The loops of this crate and of its
//! users read the flag every few milliseconds ([`check`]). Once it is set they unwind with [`Cancelled`] to the nearest
//! `catch_unwind`. The flag never changes a result.

use std::cell::RefCell;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Panic payload of a cancelled computation. It bypasses the panic hook.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

thread_local! {
    static FLAG: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Restores the previous flag on drop.
struct Restored(Option<Arc<AtomicBool>>);

impl Drop for Restored {
    fn drop(&mut self) {
        FLAG.set(self.0.take());
    }
}

/// Computes on this thread until the flag is set.
///
/// # Panics
/// Unwinds with [`Cancelled`] once a loop has seen the flag.
pub fn watched<T>(flag: &Arc<AtomicBool>, compute: impl FnOnce() -> T) -> T {
    let _restored = Restored(FLAG.replace(Some(Arc::clone(flag))));
    compute()
}

/// Computes to the end regardless of the flag: for values shared by all frames, which must not stay incomplete.
pub fn unwatched<T>(compute: impl FnOnce() -> T) -> T {
    let _restored = Restored(FLAG.replace(None));
    compute()
}

/// Ends a cancelled computation. Otherwise it costs a nanosecond: call it for each row, not for each pixel.
///
/// # Panics
/// Unwinds with [`Cancelled`].
#[inline]
pub fn check() {
    if FLAG.with_borrow(|flag| flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))) {
        end();
    }
}

#[cold]
fn end() -> ! {
    resume_unwind(Box::new(Cancelled))
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;
    use crate::{Plane, Rgb};

    fn outcome<T>(flag: &Arc<AtomicBool>, compute: impl FnOnce() -> T) -> Option<T> {
        let caught = catch_unwind(AssertUnwindSafe(|| watched(flag, compute)));
        caught.map_err(|payload| assert!(payload.is::<Cancelled>())).ok()
    }

    #[test]
    fn loops_end_at_the_next_row_once_the_flag_is_set() {
        let flag = Arc::new(AtomicBool::new(false));
        let set = || flag.store(true, Ordering::Relaxed);
        let mut seen = 0;
        let cancelled = outcome(&flag, || {
            Plane::from_fn(10, 100, |x, y| {
                if (x, y) == (9, 3) {
                    set();
                }
                seen += 1;
            })
        });
        assert_eq!((cancelled, seen), (None, 40));
        assert!(outcome(&flag, || Rgb::from_fn(2, 2, |_, _| [0u8; 3])).is_none());
        assert!(outcome(&flag, || crate::vectorized!(1 + 1)).is_none());
        assert_eq!(
            outcome(&flag, || unwatched(|| crate::vectorized!(1 + 1))),
            Some(2)
        );
        // The flag no longer applies to this thread.
        check();
        flag.store(false, Ordering::Relaxed);
        assert_eq!(outcome(&flag, || crate::vectorized!(1 + 1)), Some(2));
    }
}
