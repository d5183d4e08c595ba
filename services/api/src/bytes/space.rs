//! Tracks whether the disk is full, and keeps a reserve for deletions.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::http::failure::storage_full;
use crate::http::problem::Problem;

/// Bytes written to test for free space: as much as a few frames need.
const PROBE_BYTES: usize = 4 << 20;
/// The test file, overwritten each time and removed.
const PROBE: &str = "space.probe";

/// A file whose space is released for a deletion on a full disk: a deletion must write before it frees space.
const RESERVE: &str = "space.reserve";

/// The state of the disk space.
pub(crate) struct Space {
    folder: PathBuf,
    pub(super) full: AtomicBool,
    reserve_bytes: u64,
    /// Whether a deletion has the reserve. Other writes are rejected until it is restored.
    given: AtomicBool,
    /// Whether that deletion is still running.
    in_use: AtomicBool,
    /// Held by a probe: all write the same file.
    probing: Mutex<()>,
}

impl Space {
    /// Writes the reserve if there is room, and checks whether the disk is already full.
    pub(crate) fn new(folder: &Path, reserve_bytes: u64) -> Self {
        let space = Self {
            folder: folder.to_owned(),
            full: AtomicBool::new(false),
            reserve_bytes,
            given: AtomicBool::new(false),
            in_use: AtomicBool::new(false),
            probing: Mutex::default(),
        };
        if let Err(error) = space.lay_aside() {
            tracing::warn!(%error, "no space for a reserve; deletions will fail on a full disk");
        }
        space.full.store(space.probe().is_err(), Ordering::SeqCst);
        space
    }

    /// Releases the reserve for a deletion; returns false without a reserve.
    pub(crate) fn give_reserve(&self) -> bool {
        let given = std::fs::remove_file(self.folder.join(RESERVE)).is_ok();
        if given {
            tracing::warn!("the disk is full; using the reserve for a deletion");
            self.in_use.store(true, Ordering::SeqCst);
            self.given.store(true, Ordering::SeqCst);
            self.full.store(true, Ordering::SeqCst);
        }
        given
    }

    /// Ends the deletion's use of the reserve, which is written again as soon as there is room.
    pub(crate) async fn take_reserve_back(self: &Arc<Self>) {
        self.in_use.store(false, Ordering::SeqCst);
        self.is_full().await;
    }

    /// Rejects writes while a deletion has the reserve and it cannot be restored.
    pub(crate) async fn room(self: &Arc<Self>) -> Result<(), Problem> {
        if self.given.load(Ordering::SeqCst) && self.is_full().await {
            return Err(storage_full(&"the reserve is in use"));
        }
        Ok(())
    }

    /// Whether the service ran out of space and still has none.
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

    pub(super) fn probe(&self) -> io::Result<()> {
        let _alone = self.probing.lock().unwrap_or_else(PoisonError::into_inner);
        let path = self.folder.join(PROBE);
        if self.in_use.load(Ordering::SeqCst) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let laid_aside = self.lay_aside();
        if self.given.load(Ordering::SeqCst) {
            laid_aside?;
        }
        let written = File::create(&path).and_then(|mut file| {
            file.write_all(&vec![1; PROBE_BYTES])?;
            file.sync_all()
        });
        let removed = std::fs::remove_file(&path);
        written.and(removed)
    }

    /// Writes the reserve atomically.
    fn lay_aside(&self) -> io::Result<()> {
        let path = self.folder.join(RESERVE);
        if std::fs::metadata(&path).map_or(0, |file| file.len()) != self.reserve_bytes {
            let written = File::create(&path).and_then(|file| fill(file, self.reserve_bytes));
            if written.is_err() {
                std::fs::remove_file(&path)?;
            }
            written?;
        }
        self.given.store(false, Ordering::SeqCst);
        Ok(())
    }
}

/// Writes incompressible bytes, so that the file takes its full size on every file system.
fn fill(mut file: File, bytes: u64) -> io::Result<()> {
    let mut state = 1_u64;
    let mut block = [0; 1 << 16];
    for at in (0..bytes).step_by(block.len()) {
        for word in block.chunks_exact_mut(8) {
            // Marsaglia (2003), xorshift64.
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            word.copy_from_slice(&state.to_le_bytes());
        }
        let length = block.len().min((bytes - at) as usize);
        file.write_all(&block[..length])?;
    }
    file.sync_all()
}
