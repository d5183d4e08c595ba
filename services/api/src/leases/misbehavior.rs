//! Workers whose reports were rejected as impossible.

use std::collections::{BTreeMap, BTreeSet};

/// A worker is dismissed after this many rejected reports; a single one may be a transmission error.
const MAX_REJECTIONS: u32 = 3;
/// Maximum stored names; they come from workers.
const MAX_NAMES: usize = 1000;

/// Rejected reports and dismissed workers since the service started.
#[derive(Default)]
pub(crate) struct Misbehavior {
    rejections: BTreeMap<String, u32>,
    dismissed: BTreeSet<String>,
    /// Dismissed workers started by the service.
    pub(super) own: BTreeSet<String>,
}

impl Misbehavior {
    /// Counts a rejected report of a worker; returns whether that dismisses it.
    pub(crate) fn count_rejection(&mut self, id: &str, name: &str, is_own: bool) -> bool {
        let count = self.rejections.entry(id.to_owned()).or_default();
        *count += 1;
        if *count < MAX_REJECTIONS {
            return false;
        }
        self.dismiss(id, name, is_own);
        true
    }

    /// Blocks registrations with this worker's name.
    pub(crate) fn dismiss(&mut self, id: &str, name: &str, is_own: bool) {
        self.rejections.remove(id);
        if self.dismissed.len() < MAX_NAMES {
            self.dismissed.insert(name.to_owned());
        }
        if is_own {
            self.own.insert(name.to_owned());
        }
    }

    /// Whether workers of this name are dismissed.
    pub(crate) fn is_dismissed(&self, name: &str) -> bool {
        self.dismissed.contains(name)
    }

    /// Drops the counts of unregistered workers.
    pub(crate) fn retain_registered(&mut self, is_registered: impl Fn(&str) -> bool) {
        self.rejections.retain(|id, _| is_registered(id));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_third_rejection_dismisses_a_worker_and_its_name() {
        let mut misbehavior = Misbehavior::default();
        let refused = |misbehavior: &mut Misbehavior, id, name| misbehavior.count_rejection(id, name, false);
        assert!(!refused(&mut misbehavior, "wrk_1", "a") && !refused(&mut misbehavior, "wrk_1", "a"));
        assert!(!refused(&mut misbehavior, "wrk_2", "b"));
        assert!(!misbehavior.is_dismissed("a"));
        assert!(refused(&mut misbehavior, "wrk_1", "a"));
        assert!(misbehavior.is_dismissed("a") && !misbehavior.is_dismissed("b"));
        misbehavior.retain_registered(|_| false);
        assert!(!refused(&mut misbehavior, "wrk_2", "b"));
    }
}
