//! Images and their artifacts.

pub(crate) mod rerender;
pub(crate) mod routes;

use catalogue::ImageRow;
use serde_json::Value;
use spec::ArtifactEntry;

use crate::app::App;
use crate::http::problem::{Problem, Slug};
use crate::http::time::rfc3339;

/// An image as clients see it: its record and what the service knows beside it.
pub(crate) fn view(image: ImageRow) -> Value {
    let mut record = image.record;
    if let Some(members) = record.as_object_mut() {
        members.insert("job".to_owned(), image.job_id.into());
        members.insert("dataset".to_owned(), image.dataset.into());
        members.insert("created_at".to_owned(), rfc3339(image.created_ms).into());
    }
    record
}

/// The stored bytes of an artifact, verified.
pub(crate) async fn bytes(app: &App, entry: &ArtifactEntry) -> Result<Vec<u8>, Problem> {
    let bytes = app.store.get(&entry.digest).await?;
    bytes.ok_or_else(|| {
        tracing::error!(
            digest = entry.digest,
            kind = entry.kind,
            "a stored artifact is missing"
        );
        Problem::new(
            Slug::CorruptArtifact,
            format!("the bytes of artifact {} are missing", entry.digest),
        )
    })
}
