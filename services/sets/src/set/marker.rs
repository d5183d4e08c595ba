//! The marker of a shard. The process that creates it has completed the shard.

use serde::{Deserialize, Serialize};

use crate::error::SetError;
use crate::storage::layout;
use crate::storage::store::Store;
use crate::storage::upload::FileSum;

/// A frame without an image.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailedFrame {
    /// Position in the job.
    pub frame: u64,
    /// Why.
    pub error: String,
}

/// The content of `done/SHARD.json`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Marker {
    /// Number of the shard.
    pub shard: u64,
    /// Which files of the shard count.
    pub attempt: String,
    /// Digest over the frames that have an image, independent of host, time and attempt.
    pub digest: String,
    /// Number of images.
    pub images: u64,
    /// Frames without an image.
    pub failed: Vec<FailedFrame>,
    /// The artifacts.
    pub tar: FileSum,
    /// The rows.
    pub rows: FileSum,
    /// CPU features of the machine, which choose code paths.
    pub cpu_features: String,
}

/// What became of a marker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Commit {
    /// It is the shard's.
    Won,
    /// Another attempt was first, with the same content.
    Lost,
    /// Another attempt was first, with other content.
    Contradicted {
        /// Digest of the existing marker.
        existing: String,
    },
}

impl Marker {
    pub(crate) fn read(name: &str, text: &[u8]) -> Result<Self, SetError> {
        serde_json::from_slice(text).map_err(|error| SetError::unreadable(name, error))
    }

    /// Name of the tar.
    #[must_use]
    pub fn tar_name(&self) -> String {
        layout::tar(self.shard, &self.attempt)
    }

    /// Name of the rows.
    #[must_use]
    pub fn rows_name(&self) -> String {
        layout::rows(self.shard, &self.attempt)
    }

    /// Creates the marker unless the shard has one. Both files are complete before this is called.
    pub(crate) fn commit(&self, store: &Store) -> Result<Commit, SetError> {
        let text = serde_json::to_vec_pretty(self)
            .map_err(|error| SetError::Machine(format!("the marker cannot be written: {error}")))?;
        if !self.failed.is_empty() {
            // Written before the marker, so that a listing of `failed/` contains every shard with failed frames.
            store.replace(&layout::failed(self.shard), b"")?;
        }
        let name = layout::done(self.shard);
        let Some(found) = store.create(&name, &text)? else {
            return Ok(Commit::Won);
        };
        let first = Self::read(&name, &found)?;
        if first.digest == self.digest {
            return Ok(Commit::Lost);
        }
        store.replace(&layout::alarm(self.shard, &self.attempt), &text)?;
        Ok(Commit::Contradicted {
            existing: first.digest,
        })
    }
}
