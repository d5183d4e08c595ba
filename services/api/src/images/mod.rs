//! Images and their artifacts.

mod archive;
pub(crate) mod rerender;
pub(crate) mod routes;

use std::path::PathBuf;
use std::sync::Arc;

use catalogue::Catalogue;
use serde::Deserialize;
use serde_json::Value;
use spec::ArtifactEntry;

use crate::bytes::Bytes;
use crate::http::problem::{Problem, Slug, found};
use crate::http::stored::Stored;
use crate::processes::Processes;

/// Stored images and their verification.
pub(crate) struct Images {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) processes: Arc<Processes>,
    /// The service's folder.
    pub(crate) data: PathBuf,
}

impl Images {
    /// The record of an image, with its job, its dataset and when it was stored.
    pub(crate) async fn get(&self, job: &str, frame: u64) -> Result<Value, Problem> {
        let image = self.catalogue.image(job, frame).await?;
        found(image, "image", format_args!("{job}/{frame}"))
    }

    /// All artifacts of an image, in the order of its record.
    async fn entries(&self, job: &str, frame: u64) -> Result<Vec<ArtifactEntry>, Problem> {
        let image = self.get(job, frame).await?;
        Vec::deserialize(&image["artifacts"]).map_err(|error| Problem::internal(&error))
    }

    async fn artifact(&self, job: &str, frame: u64, kind: &str) -> Result<ArtifactEntry, Problem> {
        let entry = self.catalogue.artifact(job, frame, kind).await?;
        entry.ok_or_else(|| Problem::not_found(format!("no artifact `{kind}` of image `{job}/{frame}`")))
    }

    /// The bytes of an artifact, verified.
    pub(crate) async fn stored(&self, entry: ArtifactEntry) -> Result<Stored, Problem> {
        let ArtifactEntry {
            kind,
            digest,
            media_type,
            ..
        } = entry;
        let Some(bytes) = self.bytes.store.get(&digest).await? else {
            tracing::error!(digest, kind, "a stored artifact is missing");
            let detail = format!("the bytes of artifact {digest} are missing");
            return Err(Problem::new(Slug::CorruptArtifact, detail));
        };
        Ok(Stored {
            digest,
            media_type,
            bytes,
        })
    }
}
