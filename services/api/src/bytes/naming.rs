//! Protects bytes from deletion until the row with their digest is stored.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard};

/// How long a frame's artifacts are kept for its commit, which usually follows within seconds. A later commit is
/// rejected and the frame fails, so no wrong image is stored.
const FRESH: Duration = Duration::from_secs(600);

/// Digests of stored bytes without a row.
#[derive(Default)]
pub(crate) struct Naming {
    turns: RwLock<()>,
    fresh: Mutex<HashMap<String, Instant>>,
}

impl Naming {
    /// Shared guard: held while storing a row whose digests are known to exist.
    pub(crate) async fn beside_others(&self) -> RwLockReadGuard<'_, ()> {
        self.turns.read().await
    }

    /// Exclusive guard: held while deleting digests.
    pub(crate) async fn alone(&self) -> RwLockWriteGuard<'_, ()> {
        self.turns.write().await
    }

    /// Protects digests that will be stored and then referenced by a row.
    pub(crate) async fn announce(&self, digests: impl IntoIterator<Item = String>) {
        let _turn = self.beside_others().await;
        let now = Instant::now();
        self.digests()
            .extend(digests.into_iter().map(|digest| (digest, now)));
    }

    /// Ends the protection of digests that have a row.
    pub(crate) fn named<'a>(&self, digests: impl IntoIterator<Item = &'a str>) {
        let mut fresh = self.digests();
        for digest in digests {
            fresh.remove(digest);
        }
    }

    /// Whether a digest is protected.
    pub(crate) fn is_fresh(&self, digest: &str) -> bool {
        self.digests()
            .get(digest)
            .is_some_and(|since| since.elapsed() < FRESH)
    }

    /// Drops expired protections.
    pub(crate) fn tidy_up(&self) {
        self.digests().retain(|_, since| since.elapsed() < FRESH);
    }

    fn digests(&self) -> MutexGuard<'_, HashMap<String, Instant>> {
        self.fresh.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
