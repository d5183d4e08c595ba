//! What was put for frames that are not committed yet: a commit names these files and no others.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use proto::wire::Claim;
use spec::ArtifactEntry;

/// A stored file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Put {
    pub(crate) entry: ArtifactEntry,
    /// Columns and rows that its header announces; none of a file that has no sides.
    pub(crate) sides: Option<(usize, usize)>,
}

/// Token, frame and attempt of a claim.
type Key = (u64, u64, u32);

/// The files of each claim.
#[derive(Default)]
pub(crate) struct Puts(Mutex<HashMap<Key, Vec<Put>>>);

fn key(claim: &Claim) -> Key {
    (claim.token, claim.frame, claim.attempt)
}

impl Puts {
    /// Adds files. One of a kind that is there replaces it: a worker that missed a response puts its files again.
    pub(crate) fn add(&self, claim: &Claim, files: Vec<Put>) {
        let mut all = self.all();
        let known = all.entry(key(claim)).or_default();
        known.retain(|old| files.iter().all(|new| new.entry.kind != old.entry.kind));
        known.extend(files);
    }

    /// The files of a claim.
    pub(crate) fn get(&self, claim: &Claim) -> Vec<Put> {
        self.all().get(&key(claim)).cloned().unwrap_or_default()
    }

    /// Forgets the files of a claim.
    pub(crate) fn remove(&self, claim: &Claim) {
        self.all().remove(&key(claim));
    }

    /// Forgets the files of leases that have ended.
    pub(crate) fn tidy_up(&self, is_current: impl Fn(u64) -> bool) {
        self.all().retain(|(token, ..), _| is_current(*token));
    }

    fn all(&self) -> MutexGuard<'_, HashMap<Key, Vec<Put>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(kind: &str, digest: &str) -> Put {
        Put {
            entry: ArtifactEntry {
                kind: kind.to_owned(),
                digest: digest.to_owned(),
                bytes: 1,
                media_type: "image/png".to_owned(),
            },
            sides: None,
        }
    }

    #[test]
    fn files_belong_to_one_attempt_and_go_with_its_lease() {
        let puts = Puts::default();
        let first = Claim {
            token: 7,
            job_id: "job_a".to_owned(),
            frame: 3,
            attempt: 1,
        };
        let second = Claim {
            attempt: 2,
            ..first.clone()
        };
        puts.add(&first, vec![put("rgb", "a"), put("range", "b")]);
        puts.add(&first, vec![put("rgb", "c")]);
        assert_eq!(puts.get(&first), [put("range", "b"), put("rgb", "c")]);
        assert!(puts.get(&second).is_empty());
        puts.tidy_up(|token| token == 7);
        assert_eq!(puts.get(&first).len(), 2);
        puts.tidy_up(|_| false);
        assert!(puts.get(&first).is_empty());
    }
}
