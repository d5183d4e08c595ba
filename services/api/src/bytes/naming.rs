//! Keeps bytes from being deleted while a row that names them is about to be stored.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard};

/// How long a frame's artifacts are kept for its commit, which usually follows at once. A later commit is refused, and
/// the frame is given up: nothing wrong is ever stored.
const FRESH: Duration = Duration::from_secs(600);

/// The digests that are stored and not yet named.
#[derive(Default)]
pub(crate) struct Naming {
    turns: RwLock<()>,
    fresh: Mutex<HashMap<String, Instant>>,
}

impl Naming {
    /// Held while a row is stored that names digests which are known to be there.
    pub(crate) async fn beside_others(&self) -> RwLockReadGuard<'_, ()> {
        self.turns.read().await
    }

    /// Held while digests are deleted.
    pub(crate) async fn alone(&self) -> RwLockWriteGuard<'_, ()> {
        self.turns.write().await
    }

    /// Announces digests that are about to be stored and then named.
    pub(crate) async fn announce(&self, digests: impl IntoIterator<Item = String>) {
        let _turn = self.beside_others().await;
        let now = Instant::now();
        self.digests()
            .extend(digests.into_iter().map(|digest| (digest, now)));
    }

    /// Removes digests that have been named.
    pub(crate) fn named<'a>(&self, digests: impl IntoIterator<Item = &'a str>) {
        let mut fresh = self.digests();
        for digest in digests {
            fresh.remove(digest);
        }
    }

    /// Whether a digest is about to be named.
    pub(crate) fn is_fresh(&self, digest: &str) -> bool {
        self.digests()
            .get(digest)
            .is_some_and(|since| since.elapsed() < FRESH)
    }

    /// Forgets what was never named.
    pub(crate) fn tidy_up(&self) {
        self.digests().retain(|_, since| since.elapsed() < FRESH);
    }

    fn digests(&self) -> MutexGuard<'_, HashMap<String, Instant>> {
        self.fresh.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
