//! A frame of a stream.

use serde_json::Value;
use spec::{ArtifactKind, Encode, FrameRecord};

use crate::content::Content;
use crate::error::RenderError;
use crate::file::File;
use crate::stage::files;

/// A rendered frame of a stream.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamFrame {
    /// The picture, the range of an input with distances, every enhancement, and the other artifacts of the job that the
    /// frame has.
    pub artifacts: Vec<(ArtifactKind, Content<'static>)>,
    /// Everything known about the picture.
    pub record: FrameRecord,
    /// Milliseconds from the call to the result.
    pub elapsed_ms: f64,
}

impl StreamFrame {
    /// The content of an artifact.
    #[must_use]
    pub fn content(&self, kind: &ArtifactKind) -> Option<&Content<'static>> {
        let found = self.artifacts.iter().find(|(known, _)| known == kind);
        found.map(|(_, content)| content)
    }

    /// The artifacts as files, pictures in this format; the record then lists them.
    ///
    /// # Errors
    /// [`RenderError::Encode`].
    pub fn encode(self, encode: Encode) -> Result<(Vec<File>, FrameRecord), RenderError> {
        let mut record = self.record;
        let mut encoded = Vec::with_capacity(self.artifacts.len());
        for (kind, content) in self.artifacts {
            encoded.push(files::encode_file(&kind, content, encode, &mut record)?);
        }
        files::list_files(&encoded, &mut record);
        Ok((encoded, record))
    }

    /// The plan: every stage with its variant, error bound and expected cost.
    #[must_use]
    pub fn plan(&self) -> &Value {
        &self.record.plan
    }

    /// Bound on the error of the exposed light up to white; `None` if the job has no tolerance.
    #[must_use]
    pub fn error_bound(&self) -> Option<f64> {
        let promise = self.record.promise.as_ref()?;
        Some(promise.bound + promise.relative)
    }
}
