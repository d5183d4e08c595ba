//! Files of uncommitted frames. A commit must name exactly these files.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use proto::wire::Claim;
use spec::{ArtifactEntry, Frame};

/// A stored file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Put {
    pub(crate) entry: ArtifactEntry,
    /// Columns and rows of its header; `None` for a file that is not an image.
    pub(crate) sides: Option<(usize, usize)>,
}

/// Token, frame and attempt of a claim.
type Key = (u64, u64, u32);

/// A frame before its commit.
#[derive(Clone)]
pub(crate) struct Uncommitted {
    pub(crate) frame: Arc<Frame>,
    pub(crate) files: Vec<Put>,
}

/// Uncommitted frames by claim.
#[derive(Default)]
pub(crate) struct Puts(Mutex<HashMap<Key, Uncommitted>>);

fn key(claim: &Claim) -> Key {
    (claim.token, claim.frame, claim.attempt)
}

impl Puts {
    /// Adds files. A file replaces an earlier one of its kind: a worker that missed a response sends its files again.
    pub(crate) fn add(&self, claim: &Claim, frame: Arc<Frame>, files: Vec<Put>) {
        let mut all = self.all();
        let known = &mut all
            .entry(key(claim))
            .or_insert_with(|| Uncommitted { frame, files: vec![] })
            .files;
        known.retain(|old| files.iter().all(|new| new.entry.kind != old.entry.kind));
        known.extend(files);
    }

    /// The frame and the files of a claim, if any were stored.
    pub(crate) fn get(&self, claim: &Claim) -> Option<Uncommitted> {
        self.all().get(&key(claim)).cloned()
    }

    /// Drops the files of a claim.
    pub(crate) fn remove(&self, claim: &Claim) {
        self.all().remove(&key(claim));
    }

    /// Drops the files of ended leases.
    pub(crate) fn tidy_up(&self, is_current: impl Fn(u64) -> bool) {
        self.all().retain(|(token, ..), _| is_current(*token));
    }

    fn all(&self) -> MutexGuard<'_, HashMap<Key, Uncommitted>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leases::checks::tests::frame;

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
        let files = |claim| puts.get(claim).map(|known| known.files);
        let frame = Arc::new(frame());
        puts.add(
            &first,
            Arc::clone(&frame),
            vec![put("rgb", "a"), put("range", "b")],
        );
        puts.add(&first, frame, vec![put("rgb", "c")]);
        assert_eq!(files(&first), Some(vec![put("range", "b"), put("rgb", "c")]));
        assert_eq!(files(&second), None);
        puts.tidy_up(|token| token == 7);
        assert!(files(&first).is_some());
        puts.tidy_up(|_| false);
        assert_eq!(files(&first), None);
    }
}
