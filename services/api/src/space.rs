//! Whether there is space on the disk, as far as the service has noticed.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::Response;

use crate::problem::{Problem, Slug};

/// Written to see whether there is space again: as much as a few frames need.
const PROBE_BYTES: usize = 4 << 20;
/// Its file, overwritten each time and removed.
const PROBE: &str = "space.probe";

/// What is known of the space.
pub(crate) struct Space {
    folder: PathBuf,
    full: AtomicBool,
}

impl Space {
    pub(crate) fn of(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            full: AtomicBool::new(false),
        }
    }

    /// Whether the service ran out of space and there is still none.
    pub(crate) async fn is_full(self: &Arc<Self>) -> bool {
        if !self.full.load(Ordering::SeqCst) {
            return false;
        }
        let space = Arc::clone(self);
        let probed = tokio::task::spawn_blocking(move || space.probe()).await;
        let full = !matches!(probed, Ok(Ok(())));
        self.full.store(full, Ordering::SeqCst);
        full
    }

    /// Size of the catalogue's write-ahead log.
    pub(crate) async fn wal_bytes(&self) -> u64 {
        let file = tokio::fs::metadata(self.folder.join("catalogue.sqlite-wal")).await;
        file.map_or(0, |file| file.len())
    }

    fn probe(&self) -> io::Result<()> {
        let path = self.folder.join(PROBE);
        let written = std::fs::write(&path, vec![1; PROBE_BYTES]);
        let removed = std::fs::remove_file(&path);
        written.and(removed)
    }
}

/// Takes note of answers that say that the disk is full.
pub(crate) async fn note(State(space): State<Arc<Space>>, request: Request, next: Next) -> Response {
    let answer = next.run(request).await;
    let problem = answer.extensions().get::<Problem>();
    if problem.is_some_and(|problem| problem.is(Slug::StorageFull)) {
        space.full.store(true, Ordering::SeqCst);
    }
    answer
}
