//! Images and their artifacts.

mod archive;
pub(crate) mod heal;
pub(crate) mod rerender;
pub(crate) mod routes;

use std::path::PathBuf;
use std::sync::Arc;

use catalogue::{Catalogue, StoredArtifact};
use serde::Deserialize;
use serde_json::Value;
use spec::ArtifactEntry;
use store::StoreError;

use crate::bytes::Bytes;
use crate::http::problem::{Problem, Slug, found};
use crate::http::stored::Stored;
use crate::processes::Processes;

/// Stored images and their verification.
pub(crate) struct Images {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) processes: Arc<Processes>,
    /// The data folder.
    pub(crate) data: PathBuf,
}

impl Images {
    /// The record of an image, with its job, dataset and storage time.
    pub(crate) async fn get(&self, job: &str, frame: u64) -> Result<Value, Problem> {
        let image = self.catalogue.image(job, frame).await?;
        found(image, "image", format_args!("{job}/{frame}"))
    }

    /// All artifacts of an image, in the order of its record.
    async fn artifacts(&self, job: &str, frame: u64) -> Result<Vec<StoredArtifact>, Problem> {
        let image = self.get(job, frame).await?;
        let entries = Vec::<ArtifactEntry>::deserialize(&image["artifacts"]);
        let entries = entries.map_err(|error| Problem::internal(&error))?;
        let mut artifacts = Vec::with_capacity(entries.len());
        for entry in entries {
            artifacts.push(self.artifact(job, frame, &entry.kind).await?);
        }
        Ok(artifacts)
    }

    /// An artifact of an image.
    pub(crate) async fn artifact(
        &self,
        job: &str,
        frame: u64,
        kind: &str,
    ) -> Result<StoredArtifact, Problem> {
        let entry = self.catalogue.artifact(job, frame, kind).await?;
        entry.ok_or_else(|| Problem::not_found(format!("no artifact `{kind}` of image `{job}/{frame}`")))
    }

    /// Reads and verifies the bytes of an artifact.
    pub(crate) async fn stored(&self, artifact: StoredArtifact) -> Result<Stored, Problem> {
        let bytes = match &artifact.place {
            Some(place) => Some(self.bytes.sets.read(place, &artifact.entry).await?),
            None => self.read_pack(&artifact).await?,
        };
        let ArtifactEntry {
            kind,
            digest,
            media_type,
            ..
        } = artifact.entry;
        let Some(bytes) = bytes else {
            tracing::error!(digest, kind, "a stored artifact is missing");
            return Err(Problem::new(Slug::CorruptArtifact, describe_missing(&digest)));
        };
        Ok(Stored {
            digest,
            media_type,
            bytes,
        })
    }

    /// Reads the bytes of an artifact from the packs; `None` if they are missing. Notes damage, so that the frame is rendered
    /// again.
    pub(crate) async fn read_pack(&self, artifact: &StoredArtifact) -> Result<Option<Vec<u8>>, StoreError> {
        let digest = &artifact.entry.digest;
        let read = self.bytes.store.get(digest).await;
        let damage = match &read {
            Ok(None) => Some(describe_missing(digest)),
            Err(error @ StoreError::Corrupt { .. }) => Some(error.to_string()),
            _ => None,
        };
        if let Some(what) = damage {
            self.catalogue.note_damaged_artifact(&artifact.image, &what);
        }
        read
    }
}

/// The detail of the response, and the finding that it becomes.
fn describe_missing(digest: &str) -> String {
    format!("the bytes of artifact {digest} are missing")
}
