//! Files of uncommitted frames. A commit must name exactly these files.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use spec::{ArtifactEntry, Frame};
use wire::messages::Claim;

/// A stored file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PendingArtifact {
    pub(crate) entry: ArtifactEntry,
    /// Columns and rows of its header; `None` for a file that is not an image.
    pub(crate) sides: Option<(usize, usize)>,
}

/// Token, frame and attempt of a claim.
type Key = (u64, u64, u32);

/// A frame before its commit.
#[derive(Clone)]
pub(crate) struct PendingFrame {
    pub(crate) frame: Arc<Frame>,
    pub(crate) files: Vec<PendingArtifact>,
}

/// PendingFrame frames by claim.
#[derive(Default)]
pub(crate) struct PendingArtifacts(Mutex<HashMap<Key, PendingFrame>>);

fn key(claim: &Claim) -> Key {
    (claim.token, claim.frame, claim.attempt)
}

impl PendingArtifacts {
    /// Adds files. A file replaces an earlier one of its kind: a worker that missed a response sends its files again.
    pub(crate) fn add(&self, claim: &Claim, frame: Arc<Frame>, files: Vec<PendingArtifact>) {
        let mut all = self.all();
        let known = &mut all
            .entry(key(claim))
            .or_insert_with(|| PendingFrame { frame, files: vec![] })
            .files;
        known.retain(|old| files.iter().all(|new| new.entry.kind != old.entry.kind));
        known.extend(files);
    }

    /// The frame and the files of a claim, if any were stored.
    pub(crate) fn get(&self, claim: &Claim) -> Option<PendingFrame> {
        self.all().get(&key(claim)).cloned()
    }

    /// Drops the files of a claim.
    pub(crate) fn remove(&self, claim: &Claim) {
        self.all().remove(&key(claim));
    }

    /// Drops the files of ended leases.
    pub(crate) fn drop_ended(&self, is_current: impl Fn(u64) -> bool) {
        self.all().retain(|(token, ..), _| is_current(*token));
    }

    fn all(&self) -> MutexGuard<'_, HashMap<Key, PendingFrame>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leases::checks::tests::frame;

    fn put(kind: &str, digest: &str) -> PendingArtifact {
        PendingArtifact {
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
        let pending = PendingArtifacts::default();
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
        let files = |claim| pending.get(claim).map(|known| known.files);
        let frame = Arc::new(frame());
        pending.add(
            &first,
            Arc::clone(&frame),
            vec![put("rgb", "a"), put("range", "b")],
        );
        pending.add(&first, frame, vec![put("rgb", "c")]);
        assert_eq!(files(&first), Some(vec![put("range", "b"), put("rgb", "c")]));
        assert_eq!(files(&second), None);
        pending.drop_ended(|token| token == 7);
        assert!(files(&first).is_some());
        pending.drop_ended(|_| false);
        assert_eq!(files(&first), None);
    }
}
