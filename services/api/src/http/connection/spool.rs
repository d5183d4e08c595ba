//! Bodies of uploads: on disk while they arrive, in memory when it is their turn.

use std::io::{self, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use axum::body::{Body, Bytes};
use futures::stream;
use tokio::fs::File;
use tokio::io::{AsyncReadExt, AsyncSeekExt, AsyncWriteExt};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::http::failure::writing;
use crate::http::problem::Problem;

/// Bytes per permit in the budgets of bodies.
pub(crate) const PLACE_BYTES: usize = 1 << 10;
/// Bytes that are read from the disk at a time.
const PIECE_BYTES: usize = 256 << 10;

/// The folder of bodies until their turn.
#[derive(Clone)]
pub(crate) struct Spool {
    folder: PathBuf,
    /// KiB of bodies that handlers have at the same time: their forms are in memory.
    turns: Arc<Semaphore>,
    most_places: usize,
}

impl Spool {
    /// `folder`: below the data folder. `working_bytes`: limit of all bodies that handlers have at the same time.
    pub(crate) fn new(folder: &Path, working_bytes: usize) -> Self {
        let most_places = working_bytes.div_ceil(PLACE_BYTES);
        Self {
            folder: folder.to_owned(),
            turns: Arc::new(Semaphore::new(most_places)),
            most_places,
        }
    }

    /// A file without a name, so that no end of the process leaves it on the disk.
    pub(super) fn begin(&self) -> Result<SpooledBody, Problem> {
        let file = tempfile::tempfile_in(&self.folder).map_err(|error| writing(&error))?;
        Ok(SpooledBody {
            spool: self.clone(),
            file: File::from_std(file),
            bytes: 0,
        })
    }
}

/// A body on disk.
pub(super) struct SpooledBody {
    spool: Spool,
    file: File,
    bytes: usize,
}

impl SpooledBody {
    pub(super) async fn add(&mut self, piece: &[u8]) -> Result<(), Problem> {
        self.bytes += piece.len();
        let written = self.file.write_all(piece).await;
        written.map_err(|error| writing(&error))
    }

    /// Waits for the turn of a complete body; it lasts as long as the permit.
    pub(super) async fn take_turn(&self) -> Result<OwnedSemaphorePermit, Problem> {
        let Spool {
            turns, most_places, ..
        } = &self.spool;
        let places = self.bytes.div_ceil(PLACE_BYTES).min(*most_places);
        let places = u32::try_from(places).unwrap_or(u32::MAX);
        let turn = Arc::clone(turns).acquire_many_owned(places).await;
        turn.map_err(|error| Problem::internal(&error))
    }

    /// The body from its beginning.
    pub(super) async fn into_body(mut self) -> Result<Body, Problem> {
        let begun = async {
            self.file.flush().await?;
            self.file.seek(SeekFrom::Start(0)).await
        };
        begun.await.map_err(|error| writing(&error))?;
        let pieces = stream::try_unfold(self.file, |mut file| async move {
            let mut piece = vec![0; PIECE_BYTES];
            let read = file.read(&mut piece).await?;
            piece.truncate(read);
            Ok::<_, io::Error>((read > 0).then(|| (Bytes::from(piece), file)))
        });
        Ok(Body::from_stream(pieces))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_body_comes_back_from_the_disk_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let spool = Spool::new(folder.path(), 1 << 20);
        let mut body = spool.begin().unwrap_or_else(|problem| panic!("{problem}"));
        let sent: Vec<u8> = (0..700_000_u32).map(|number| number as u8).collect();
        for piece in sent.chunks(9_999) {
            body.add(piece)
                .await
                .unwrap_or_else(|problem| panic!("{problem}"));
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let _turn = body
            .take_turn()
            .await
            .unwrap_or_else(|problem| panic!("{problem}"));
        let body = body
            .into_body()
            .await
            .unwrap_or_else(|problem| panic!("{problem}"));
        let read = axum::body::to_bytes(body, usize::MAX).await.unwrap();
        assert!(read == sent);
    }

    #[tokio::test(start_paused = true)]
    async fn large_bodies_take_turns() {
        let folder = tempfile::tempdir().unwrap();
        let spool = Spool::new(folder.path(), 100_000);
        let mut bodies = Vec::new();
        for bytes in [60_000, 60_000, 900_000] {
            let mut body = spool.begin().unwrap_or_else(|problem| panic!("{problem}"));
            body.add(&vec![1; bytes])
                .await
                .unwrap_or_else(|problem| panic!("{problem}"));
            bodies.push(body);
        }
        for pair in [(0, 1), (1, 2)] {
            let turn = bodies[pair.0].take_turn().await;
            let second = std::time::Duration::from_secs(1);
            assert!(
                tokio::time::timeout(second, bodies[pair.1].take_turn())
                    .await
                    .is_err()
            );
            drop(turn);
        }
        assert!(
            bodies[2].take_turn().await.is_ok(),
            "a body beyond the limit has a turn alone"
        );
    }
}
