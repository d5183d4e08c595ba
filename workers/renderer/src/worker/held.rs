//! The leases held by this worker.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// All leases of the worker, for the heartbeat.
#[derive(Default)]
pub(crate) struct Held(Mutex<BTreeMap<u64, Hold>>);

/// One lease, shared with its slot.
#[derive(Clone)]
pub(crate) struct Hold {
    pub(crate) token: u64,
    /// Cancels the computations of this lease when set.
    pub(crate) lost: Arc<AtomicBool>,
}

impl Hold {
    /// Whether the lease has ended and its remaining frames should be dropped.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::SeqCst)
    }

    pub(crate) fn lose(&self) {
        self.lost.store(true, Ordering::SeqCst);
    }
}

impl Held {
    /// Adds a new lease.
    pub(crate) fn take(&self, token: u64) -> Hold {
        let hold = Hold {
            token,
            lost: Arc::default(),
        };
        self.map().insert(token, hold.clone());
        hold
    }

    /// Removes a lease that has ended.
    pub(crate) fn end(&self, token: u64) {
        self.map().remove(&token);
    }

    /// The leases to extend with the next heartbeat.
    pub(crate) fn tokens(&self) -> Vec<u64> {
        self.map()
            .values()
            .filter(|hold| !hold.is_lost())
            .map(|hold| hold.token)
            .collect()
    }

    /// Marks leases as lost, so that their slots drop them.
    pub(crate) fn lose(&self, tokens: &[u64]) {
        let map = self.map();
        tokens
            .iter()
            .filter_map(|token| map.get(token))
            .for_each(Hold::lose);
    }

    fn map(&self) -> MutexGuard<'_, BTreeMap<u64, Hold>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_lease_is_known_to_its_slot_and_beats_no_more() {
        let held = Held::default();
        let (first, second) = (held.take(1), held.take(2));
        held.lose(&[1, 99]);
        assert!(first.is_lost() && !second.is_lost());
        assert_eq!(held.tokens(), [2]);
        held.end(2);
        assert!(held.tokens().is_empty());
    }
}
